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
    for (const char* name : {"a.jpg", "a", "png"}) EXPECT_THROW(shade::PictureFile(folder / name), UsageError);
}

TEST(PictureFile, AppearsWholeOrNotAtAll) {
    const test::ScratchFolder folder;
    EXPECT_THROW(shade::PictureFile(folder / "none/a.png"), OutputError);
    { const shade::PictureFile abandoned(folder / "a.png"); }
    EXPECT_TRUE(folder.empty());
}

}  // namespace
}  // namespace stratum
