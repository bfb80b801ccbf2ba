#include "shade/film/png.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/picture_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(WritePng, ReadsBackWithItsTexts) {
    const test::ScratchFolder folder;
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < 7 * 5 * 3; ++i) rgb.push_back(static_cast<std::uint8_t>(i * 37));
    const std::map<std::string, std::string> texts = {{"Software", "stratum 0.1.0"},
                                                      {"source",
                                                       "Pr\xc3\xbc"
                                                       "fling.vdb"},
                                                      {"empty", ""},
                                                      {"long", std::string(5000, 'x')}};
    shade::writePng(folder / "a.png", 7, 5, rgb, texts);
    const test::PngPicture back = test::readPng(folder / "a.png");
    EXPECT_EQ(back.width, 7);
    EXPECT_EQ(back.height, 5);
    EXPECT_EQ(back.rgb, rgb);
    EXPECT_EQ(back.texts, texts);
}

TEST(WritePng, RefusesWhatItCanNotWrite) {
    const test::ScratchFolder folder;
    const std::vector<std::uint8_t> rgb(3, 0);
    EXPECT_THROW(shade::writePng(folder / "none/a.png", 1, 1, rgb, {}), OutputError);
    EXPECT_THROW(shade::writePng("/dev/full", 1, 1, rgb, {}), OutputError);
    EXPECT_THROW(shade::writePng(folder / "a.png", 2, 1, rgb, {}), std::invalid_argument);
    for (const std::string& key : {std::string(), std::string(80, 'k'), std::string(" a"), std::string("a\n")})
        EXPECT_THROW(shade::writePng(folder / "a.png", 1, 1, rgb, {{key, "v"}}), std::invalid_argument);
}

}  // namespace
}  // namespace stratum
