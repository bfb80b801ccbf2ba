#include "shade/film/picture.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/picture_checks.h"

#include <gtest/gtest.h>

#include <fstream>

namespace stratum {
namespace {

shade::Film small() {
    shade::Film film(4, 3, {0, 0, 4, 3});
    film.at(1, 1) = {shade::Color(0.5f), 1.0f};
    return film;
}

TEST(PictureFile, KindIsTheNamesEnding) {
    const test::ScratchFolder folder;
    shade::PictureFile(folder / "a.png").write(small(), {{"Software", "test"}});
    shade::PictureFile(folder / "a.EXR").write(small(), {{"Software", "test"}});
    EXPECT_EQ(test::readPng(folder / "a.png").texts.at("Software"), "test");
    char magic[4] = {};
    std::ifstream(folder / "a.EXR", std::ios::binary).read(magic, 4);
    EXPECT_EQ(std::string(magic, 4), "v/1\x01");
    shade::PictureFile(folder / "a.jpeg").write(small(), {{"Software", "test"}});
    shade::PictureFile(folder / "a.webp").write(small(), {{"Software", "test"}});
    std::ifstream(folder / "a.jpeg", std::ios::binary).read(magic, 4);
    EXPECT_EQ(std::string(magic, 3), "\xff\xd8\xff");
    std::ifstream(folder / "a.webp", std::ios::binary).read(magic, 4);
    EXPECT_EQ(std::string(magic, 4), "RIFF");
    for (const char* name : {"a.gif", "a", "png"}) EXPECT_THROW(shade::PictureFile(folder / name), UsageError);
}

TEST(PictureFile, SizesThatAKindDoesNotHaveAreRefused) {
    EXPECT_NO_THROW(shade::requirePictureSize("a.png", 1000000, 1));
    EXPECT_NO_THROW(shade::requirePictureSize("a.jpg", 65500, 65500));
    EXPECT_THROW(shade::requirePictureSize("a.jpg", 1, 65501), UsageError);
    EXPECT_NO_THROW(shade::requirePictureSize("a.webp", 16383, 1));
    EXPECT_THROW(shade::requirePictureSize("a.webp", 16384, 1), UsageError);
}

TEST(PictureFile, AppearsWholeOrNotAtAll) {
    const test::ScratchFolder folder;
    EXPECT_THROW(shade::PictureFile(folder / "none/a.png"), OutputError);
    { const shade::PictureFile abandoned(folder / "a.png"); }
    EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace stratum
