#include "shade/measured/brdf_exr.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/map_files.h"
#include "shade/scan_checks.h"

namespace stratum {
namespace {

using shade::Color;

/// The known surface as a texture: `columns` x `rows` tiles; azimuths from `origin` degrees; half-vector angles if
/// asked.
void writeTexture(const std::filesystem::path& path, int columns, int rows, double origin, bool half,
                  const std::map<std::string, std::string>& attributes, int tile_w = 73, int tile_h = 91) {
    std::vector<Color> texels(static_cast<std::size_t>(columns * rows * tile_w * tile_h));
    for (int tile = 0; tile < columns * rows; ++tile) {
        const double ti = 20.0 * tile * test::kRadians;
        const glm::dvec3 light(std::sin(ti), 0.0, std::cos(ti));
        for (int y = 0; y < tile_h; ++y) {
            for (int x = 0; x < tile_w; ++x) {
                const double phi = 2.0 * std::numbers::pi * x / (tile_w - 1) - origin * test::kRadians;
                const double theta = 0.5 * std::numbers::pi * y / (tile_h - 1);
                glm::dvec3 d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
                if (half) d = 2.0 * glm::dot(d, light) * d - light;
                const int px = tile % columns * tile_w + x;
                const int py = tile / columns * tile_h + y;
                texels[static_cast<std::size_t>(py * columns * tile_w + px)] = test::knownBrdf(light, d);
            }
        }
    }
    test::writeExrMap(path, columns * tile_w, rows * tile_h, texels, attributes);
}

TEST(BrdfExr, FindsLayoutAndOriginByItself) {
    const test::ScratchFolder scratch;
    for (const auto& [columns, rows] : {std::pair{4, 1}, {1, 4}, {2, 2}}) {
        for (const double origin : {0.0, 180.0}) {
            writeTexture(scratch / "t.exr", columns, rows, origin, false, {});
            const auto scan = shade::foldScan(shade::readBrdfExr(scratch / "t.exr"));
            EXPECT_LT(test::worst(scan), 1e-3) << columns << "x" << rows << " " << origin;
        }
    }
}

TEST(BrdfExr, BelievesItsAttributes) {
    const test::ScratchFolder scratch;
    using Words = std::map<std::string, std::string>;
    for (const Words& words : {Words{{"layout", "1x4"}}, Words{{"columns", "1"}, {"rows", "4"}},
                               Words{{"layout", "1x4"}, {"thetaI", "0, 20, 40, 60"}, {"meaning", "detector"}}}) {
        writeTexture(scratch / "t.exr", 1, 4, 0.0, false, words);
        EXPECT_LT(test::worst(shade::foldScan(shade::readBrdfExr(scratch / "t.exr"))), 1e-3);
    }
    writeTexture(scratch / "t.exr", 2, 1, 0.0, false, {{"thetaI", "0,20"}});
    EXPECT_EQ(shade::readBrdfExr(scratch / "t.exr").incidences.size(), 2u);
}

TEST(BrdfExr, TellsHalfVectorsFromDetectors) {
    const test::ScratchFolder scratch;
    writeTexture(scratch / "t.exr", 1, 4, 0.0, true, {}, 145, 181);
    const auto scan = shade::foldScan(shade::readBrdfExr(scratch / "t.exr"));
    EXPECT_LT(test::worst(scan, 60.0), 0.05);  // resampled
    writeTexture(scratch / "t.exr", 1, 4, 0.0, false, {{"meaning", "half"}});
    EXPECT_GT(test::worst(shade::foldScan(shade::readBrdfExr(scratch / "t.exr")), 60.0), 0.2);
}

TEST(BrdfExr, GoesRound) {
    const test::ScratchFolder scratch;
    auto scan = test::knownScan({0, 20, 40, 60});
    scan.notes = {"MODEL"};
    shade::writeBrdfExr(scratch / "t.exr", scan);
    const auto back = shade::readBrdfExr(scratch / "t.exr");
    EXPECT_EQ(back.notes.at(0), "MODEL");
    EXPECT_LT(test::worst(shade::foldScan(back)), 1e-4);
}

TEST(BrdfExr, RefusesWhatDoesNotFit) {
    const test::ScratchFolder scratch;
    using Words = std::map<std::string, std::string>;
    for (const Words& words :
         {Words{{"layout", "3x1"}}, Words{{"layout", "wide"}}, Words{{"layout", "0x0"}}, Words{{"thetaI", "0,x"}},
          Words{{"thetaI", "60,40,20,0"}}, Words{{"thetaI", "0,20,40,95"}}, Words{{"meaning", "perhaps"}}}) {
        writeTexture(scratch / "t.exr", 1, 4, 0.0, false, words);
        EXPECT_THROW(shade::readBrdfExr(scratch / "t.exr"), InputError) << words.begin()->second;
    }
    test::writeExrMap(scratch / "t.exr", 7, 5, std::vector<Color>(35, Color(0.3f)));
    EXPECT_THROW(shade::readBrdfExr(scratch / "t.exr"), InputError);
}

}  // namespace
}  // namespace stratum
