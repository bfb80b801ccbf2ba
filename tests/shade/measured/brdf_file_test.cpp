#include "shade/measured/brdf_file.h"

#include "base/error.h"
#include "corpus.h"
#include "scratch_folder.h"
#include "shade/brdf_checks.h"
#include "shade/map_files.h"
#include "shade/scan_checks.h"

#include <zlib.h>

#include <random>

namespace stratum {
namespace {

using shade::readBrdfFile;

void writeGzip(const std::filesystem::path& path, const std::string& text) {
    gzFile file = gzopen(path.c_str(), "wb");
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
}

/// RMS relative difference to the known surface at random pairs, neither of them grazing.
double rmsError(const shade::Brdf& brdf) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    double sum = 0.0;
    constexpr int kDraws = 20000;
    for (int n = 0; n < kDraws; ++n) {
        const glm::vec3 wo = test::direction(0.25 + 0.75 * uniform(random), 6.28 * uniform(random));
        const glm::vec3 wi = test::direction(0.25 + 0.75 * uniform(random), 6.28 * uniform(random));
        const double e = double(brdf.eval(wo, wi).g / test::knownBrdf(glm::dvec3(wi), glm::dvec3(wo)).g - 1.0f);
        sum += e * e;
    }
    return std::sqrt(sum / kDraws);
}

TEST(BrdfFile, ContentDecidesNotTheName) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "a.png", test::miniDiffText(90.0));
    const auto plain = readBrdfFile(scratch / "a.png");
    EXPECT_LT(rmsError(*plain), 0.03);
    writeGzip(scratch / "b.exr", test::miniDiffText(90.0));
    EXPECT_EQ(readBrdfFile(scratch / "b.exr")->table().values(), plain->table().values());
}

TEST(BrdfFile, GoesRoundThroughMerlAndExr) {
    const test::ScratchFolder scratch;
    test::writeText(scratch / "a.bsdf", test::miniDiffText(0.0));
    const auto first = readBrdfFile(scratch / "a.bsdf");
    shade::writeBrdfFile(scratch / "t.binary", *first);
    const auto merl = readBrdfFile(scratch / "t.binary");
    EXPECT_LT(rmsError(*merl), 0.03);
    shade::writeBrdfFile(scratch / "t.exr", *first);
    const auto texture = readBrdfFile(scratch / "t.exr");
    EXPECT_LT(rmsError(*texture), 0.03);
    EXPECT_LT(test::chiSquaredZ(*merl, test::direction(0.6, 1.0), 200000, 3), 4.0);
    EXPECT_THROW(shade::writeBrdfFile(scratch / "t.jpg", *first), UsageError);
}

TEST(BrdfFile, RefusesWhatItCannotRead) {
    const test::ScratchFolder scratch;
    const auto refused = [&](const std::string& bytes) {
        test::writeText(scratch / "t", bytes);
        EXPECT_THROW(readBrdfFile(scratch / "t"), InputError);
    };
    refused("");
    refused("G1 X1 E1\n");
    refused(std::string("\x5a\0\0\0\x5a\0\0\0\xb4\0\0\0and no more", 23));
    EXPECT_THROW(readBrdfFile(scratch / "none"), InputError);
    writeGzip(scratch / "z", test::miniDiffText(0.0));
    for (const double share : {0.1, 0.5, 0.99}) {
        writeGzip(scratch / "z", test::miniDiffText(0.0));
        std::filesystem::resize_file(scratch / "z",
                                     std::uintmax_t(share * double(std::filesystem::file_size(scratch / "z"))));
        EXPECT_THROW(readBrdfFile(scratch / "z"), InputError) << share;
    }
}

TEST(BrdfFile, TablesOfTheProjectAreModelsAndSaySo) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(test::dataDir() / "brdf")) {
        if (entry.path().extension() != ".gz") continue;
        ++count;
        const auto brdf = readBrdfFile(entry.path());
        EXPECT_NE(brdf->notes().at(0).find("MODEL, NOT A MEASUREMENT"), std::string::npos) << entry.path();
        for (const double c : {0.1, 0.5, 1.0})
            EXPECT_LE(test::albedo(*brdf, test::direction(c, 0.4), 800, 400), 1.0) << entry.path() << " " << c;
        for (const std::string& note : brdf->notes()) EXPECT_EQ(note.find("TIS"), std::string::npos) << note;
    }
    EXPECT_EQ(count, 8);
}

TEST(BrdfFile, CorpusTablesKeepTheRules) {
    for (const char* name :
         {"merl_black-soft-plastic", "merl_red-plastic", "merl_white-acrylic", "rgl_vch_ultra_pink_rgb"}) {
        STRATUM_NEEDS_CORPUS(file, std::string("brdf/") + name + ".bsdf.gz");
        const auto brdf = readBrdfFile(file);
        std::printf("%s: largest albedo of the table %.3f\n", name, double(brdf->tableAlbedo()));
        for (const double c : {0.02, 0.1, 0.3, 0.7, 1.0}) {
            const glm::vec3 wo = test::direction(c, 0.4);
            EXPECT_LE(test::sampledAlbedo(*brdf, wo), 1.0) << name << " " << c;
        }
        EXPECT_NEAR(test::sampledAlbedo(*brdf, test::direction(0.8, 1.0)),
                    test::albedo(*brdf, test::direction(0.8, 1.0), 2000, 500), 5e-3)
            << name;
    }
}

}  // namespace
}  // namespace stratum
