#include "gcode/thumbnail/thumbnail_file.h"

#include "base/error.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "gcode/container_samples.h"
#include "gcode/program.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

using sample::little;

const ThumbnailSize kAsked{300, 200, ThumbnailCoding::png};
const ThumbnailSize kTiny{16, 16, ThumbnailCoding::qoi};

// Any bytes; what they are is not looked at.
std::vector<Thumbnail> drawn(const std::vector<ThumbnailSize>& sizes) {
    std::vector<Thumbnail> pictures;
    for (const ThumbnailSize& size : sizes) {
        std::string bytes = "picture of " + std::to_string(size.width) + std::string(codingName(size.coding));
        if (size.coding == ThumbnailCoding::bmp) bytes = "BM" + little(14454, 4) + std::string(14448, '\0');
        pictures.push_back({size, std::move(bytes)});
    }
    return pictures;
}

std::string patch(const std::string& bytes, const std::vector<ThumbnailSize>& asked) {
    const ThumbnailFile file(bytes, "a", asked);
    return file.patched(drawn(file.pictures())).text();
}

std::string png(int width, int height) {
    const auto big = [](int v) { return std::string("\0\0", 2) + static_cast<char>(v >> 8) + static_cast<char>(v); };
    return std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + big(width) + big(height) + "IEND\xae\x42\x60\x82";
}

TEST(ThumbnailFile, EveryContainerHoldsTheSamePrint) {
    const std::string text = sample::program(12);
    const Toolpath expected = readProgram(text);
    for (const std::string& file :
         {text, sample::gzip(text), sample::bgcode(text, 3, 2), sample::bgcode(text, 1, 0, false),
          sample::zip({{"Metadata/plate_1.gcode", text}, {"Metadata/plate_1.png", png(4, 4)}}), sample::ufp(text)}) {
        const std::string made = patch(file, {kAsked});
        EXPECT_NE(made, file);
        EXPECT_TRUE(sample::samePrint(readProgram(made), expected));
        EXPECT_EQ(patch(made, {kAsked}), made) << "the same again changes nothing";
    }
    const std::string gx = patch(sample::gx(text), {{80, 60, ThumbnailCoding::png}});
    EXPECT_TRUE(sample::samePrint(readProgram(gx), expected));
}

TEST(ThumbnailFile, BlocksOfBinaryGcode) {
    const std::string text = sample::program(3);
    for (const bool checksum : {true, false}) {
        const std::string file = sample::bgcode(text, 2, 2, checksum);
        const std::string old =
            sample::block(5, 0, little(0, 2) + little(16, 2) + little(16, 2), "\x89PNG and so on", checksum);
        std::string expected = file;
        expected.replace(
            file.find(old), old.size(),
            sample::block(5, 0, little(0, 2) + little(300, 2) + little(200, 2), "picture of 300PNG", checksum) +
                sample::block(5, 0, little(2, 2) + little(16, 2) + little(16, 2), "picture of 16QOI", checksum));
        EXPECT_EQ(patch(file, {kAsked, kTiny}), expected);
        std::string without = file;
        without.erase(file.find(old), old.size());
        EXPECT_EQ(patch(without, {kAsked, kTiny}), expected);
    }
}

TEST(ThumbnailFile, PicturesOfGx) {
    const std::string text = sample::program(2);
    const std::string file = sample::gx(text, 77);
    const ThumbnailFile plain(file, "a.gx", {{80, 60, ThumbnailCoding::png}});
    ASSERT_EQ(plain.pictures().size(), 1U);
    EXPECT_EQ(plain.pictures()[0], (ThumbnailSize{80, 60, ThumbnailCoding::bmp}));
    const std::vector<Thumbnail> bmp{{plain.pictures()[0], "BM" + little(14454, 4) + std::string(14448, '\1')}};
    const std::string made = plain.patched(bmp).text();
    EXPECT_EQ(made.substr(0x10, 12), little(58, 4) + little(58 + 14454, 4) + little(58 + 14454, 4));
    EXPECT_EQ(made.substr(0x1c, 58 - 0x1c), file.substr(0x1c, 58 - 0x1c));
    EXPECT_EQ(made.substr(58), bmp[0].bytes + text);
    EXPECT_EQ(openContainer(made, "a").filament_mm, 77);
    const ThumbnailFile large(file, "a.gx", {kAsked});
    EXPECT_THROW((void)large.pictures(), UsageError);

    // With a PNG behind the BMP.
    std::string both = sample::gx("");
    const std::size_t at = both.size();
    both += png(320, 320);
    both.replace(0x18, 4, little(both.size(), 4));
    both.replace(0x14, 4, little(at, 4));
    both += text;
    const ThumbnailFile two(both, "a.gx", {{80, 60, ThumbnailCoding::png}});
    ASSERT_EQ(two.pictures().size(), 2U);
    EXPECT_EQ(two.pictures()[1], (ThumbnailSize{320, 320, ThumbnailCoding::png}));
    EXPECT_EQ(ThumbnailFile(both, "a", {kAsked}).pictures()[1], kAsked);
    const ThumbnailFile three(both, "a", {kAsked, {10, 10, ThumbnailCoding::png}});
    EXPECT_THROW((void)three.pictures(), UsageError);
    const std::string second = png(10, 10);
    const std::string changed = two.patched(std::vector<Thumbnail>{bmp[0], {{}, second}}).text();
    EXPECT_EQ(changed.substr(0x14, 8), little(58 + 14454, 4) + little(58 + 14454 + second.size(), 4));
    EXPECT_EQ(changed.substr(58), bmp[0].bytes + second + text);
}

TEST(ThumbnailFile, PicturesOfAPlate) {
    const std::string text = sample::program(2);
    const std::string file = sample::zip({{"[Content_Types].xml", "<x/>"},
                                          {"Metadata/plate_2.png", png(512, 512)},
                                          {"Metadata/plate_2_small.png", png(128, 128)},
                                          {"Metadata/plate_2.gcode.md5", "0"},
                                          {"Metadata/plate_2.gcode", text}});
    const auto sizes = [&](std::vector<ThumbnailSize> asked) {
        return ThumbnailFile(file, "a.gcode.3mf", std::move(asked)).pictures();
    };
    EXPECT_EQ(sizes({kAsked}), (std::vector<ThumbnailSize>{kAsked, {128, 128, ThumbnailCoding::png}}));
    EXPECT_EQ(sizes({{50, 50}, kTiny, kAsked}), (std::vector<ThumbnailSize>{kAsked, {50, 50}}));
    EXPECT_THROW((void)sizes({kTiny}), UsageError);
    // What it has no place for is known: a picture of another kind, and those between the largest and the smallest.
    const auto left = [&](std::vector<ThumbnailSize> asked) {
        return ThumbnailFile(file, "a.gcode.3mf", std::move(asked)).leftOut();
    };
    EXPECT_EQ(left({kAsked}), std::vector<ThumbnailSize>());
    EXPECT_EQ(left({{50, 50}, kTiny, {70, 70}, kAsked}), (std::vector<ThumbnailSize>{kTiny, {70, 70}}));
    EXPECT_EQ(ThumbnailFile(text, "a.gcode", {kTiny}).leftOut(), std::vector<ThumbnailSize>());
    const std::string made = patch(file, {kAsked});
    EXPECT_NE(made.find("picture of 300PNG"), std::string::npos);
    EXPECT_NE(made.find("picture of 128PNG"), std::string::npos);
    EXPECT_EQ(openContainer(made, "a").text, text);  // it has no place for thumbnails

    const std::string orca = "; HEADER_BLOCK_END\n; THUMBNAIL_BLOCK_START\n; THUMBNAIL_BLOCK_END\n" + text;
    const std::string with_text = patch(sample::zip({{"Metadata/plate_1.png", png(4, 4)},
                                                     {"Metadata/plate_1.gcode.md5", "0"},
                                                     {"Metadata/plate_1.gcode", orca}}),
                                        {kTiny, kAsked});
    const Program program = openContainer(with_text, "a");
    EXPECT_NE(program.text.find("; thumbnail_QOI begin 16x16"), std::string::npos);
    EXPECT_NE(program.text.find("; thumbnail begin 300x200"), std::string::npos);
}

TEST(ThumbnailFile, ContainersWithoutAPlace) {
    const std::string text = sample::program(2);
    for (const std::string& file :
         {sample::zip({{"Metadata/plate_1.gcode", text}}), sample::zip({{"/3D/model.gcode", text}}),
          sample::zip({{"3D/3dmodel.model", "<model/>"}})})
        EXPECT_THROW(ThumbnailFile(file, "a.3mf", {kAsked}), InputError);
    std::string gx = sample::gx(text);
    gx[58] = 'X';
    const ThumbnailFile holder(gx, "a.gx", {{80, 60, ThumbnailCoding::png}});
    EXPECT_THROW((void)holder.pictures(), InputError);
}

TEST(ThumbnailFile, IsWrittenPieceByPiece) {
    const test::ScratchFolder folder;
    PatchedBytes bytes;
    bytes.keep("head ");
    bytes.keep("");
    bytes.add("new ");
    bytes.keep("tail");
    EXPECT_EQ(bytes.size(), 13U);
    EXPECT_EQ(bytes.pieces().size(), 3U);
    writePatched(bytes, folder / "a.gcode");
    EXPECT_EQ(InputFile(folder / "a.gcode").bytes(), "head new tail");
    EXPECT_THROW(writePatched(bytes, folder / "none/a.gcode"), OutputError);
}

}  // namespace
}  // namespace stratum::gcode
