#include "shade/parts/part.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/parts/merge.h"
#include "shade/parts/part_checks.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace stratum {
namespace {

namespace fs = std::filesystem;

TEST(Part, IsThatOfItsSceneAndShardAlone) {
    const test::ScratchFolder folder;
    const fs::path path = test::writePartOf(folder, test::partOf(1, 3), test::wholeFilm());
    EXPECT_TRUE(shade::isPartOf(path, "1", "s", {1, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "2", "s", {1, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "1", "t", {1, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "1", "s", {0, 3}));
    EXPECT_FALSE(shade::isPartOf(path, "1", "s", {1, 4}));
    EXPECT_FALSE(shade::isPartOf(folder / "none.exr", "1", "s", {1, 3}));
}

std::string refusalOf(const fs::path& path) {
    return test::messageOf<InputError>([&] { (void)shade::readPart(path); }, "was read");
}

TEST(Part, NumbersAreWhatTheirTypesHold) {
    const test::ScratchFolder folder;
    shade::Part part = test::partOf(1, 2);
    part.whole.bare_bed = 0.125F;
    part.whole.exposure = 1.25;
    const std::string good = test::bytesOf(test::writePartOf(folder, part, test::wholeFilm()));
    const auto said = [&](const std::string& what, const std::string& instead) {
        std::string bytes = good;
        EXPECT_EQ(what.size(), instead.size());
        const std::size_t at = bytes.find(what);
        EXPECT_NE(at, std::string::npos) << what;
        if (at != std::string::npos) bytes.replace(at, what.size(), instead);
        std::ofstream(folder / "bad.exr", std::ios::binary) << bytes;
        return refusalOf(folder / "bad.exr");
    };
    for (const auto& [what, instead] : {std::pair{"\"bare_bed\":0.125", "\"bare_bed\":1e039"},
                                        {"\"size\":[100,", "\"size\":[1e2,"},
                                        {"\"region\":[0,0,100,70]", "\"region\":[0,0,1e9,70]"}})
        EXPECT_NE(said(what, instead).find("is damaged ("), std::string::npos)
            << instead << ": " << said(what, instead);
    EXPECT_NE(said("\"bare_bed\":0.125", "\"bare_bed\":1e039").find("out of range"), std::string::npos);
    EXPECT_NE(said("\"exposure\":1.25", "\"exposure\":31.5").find("30 stops"), std::string::npos);
}

TEST(Part, WithoutAMeanNumberOfSamplesDiffersFromNoneInThat) {
    const test::ScratchFolder folder;
    shade::Part part = test::partOf(0, 2);
    part.metadata.erase(shade::kMeanSamples);
    const shade::Part read = shade::readPart(test::writePartOf(folder, part, test::wholeFilm()));
    const shade::Part other = shade::readPart(test::writePartOf(folder, test::partOf(1, 2), test::wholeFilm()));
    EXPECT_EQ(shade::differenceOf(read, read), "");
    EXPECT_EQ(shade::differenceOf(read, other), "");
    EXPECT_EQ(shade::differenceOf(other, read), "");
}

// Whatever is cut off or changed in a part: it is refused, or gives the same picture.
TEST(Part, DamageIsNeverMerged) {
    const test::ScratchFolder folder;
    const shade::Film film = test::wholeFilm();
    std::vector<fs::path> paths = {test::writePartOf(folder, test::partOf(0, 2), film),
                                   test::writePartOf(folder, test::partOf(1, 2), film)};
    (void)shade::mergeParts(folder / "good.exr", paths);
    const std::string good = test::bytesOf(paths[1]);
    const auto attempt = [&](const std::string& bytes, std::size_t at) {
        std::ofstream(folder / "bad.exr", std::ios::binary) << bytes;
        fs::remove(folder / "merged.exr");
        try {
            (void)shade::mergeParts(folder / "merged.exr", {paths[0], folder / "bad.exr"});
            EXPECT_TRUE(test::bytesOf(folder / "merged.exr") == test::bytesOf(folder / "good.exr")) << at;
        } catch (const InputError&) {
            EXPECT_FALSE(fs::exists(folder / "merged.exr")) << at;
        }
    };
    for (std::size_t at = 1; at < good.size(); at += 1 + at / 40) attempt(good.substr(0, at), at);
    for (std::size_t at = 0; at < good.size(); at += 1 + at / 200) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(bytes[at] ^ 0x21);
        attempt(bytes, at);
        bytes[at] = static_cast<char>(good[at] ^ 0x01);  // a digit becomes another
        attempt(bytes, at);
    }
}

}  // namespace
}  // namespace stratum
