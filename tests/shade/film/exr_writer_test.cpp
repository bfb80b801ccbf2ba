#include "shade/film/exr.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "shade/picture_checks.h"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(WriteExr, ReadsBackWithItsAttributes) {
    const test::ScratchFolder folder;
    shade::Film film(20, 10, {3, 2, 8, 6});
    for (int y = 2; y < 6; ++y)
        for (int x = 3; x < 8; ++x) film.at(x, y) = {shade::Color(0.1f * float(x), 100.0f * float(y), -1.5f), 0.25f};
    shade::writeExr(folder / "a.exr", film, {{"source", "part.vdb"}, {"view", "iso"}});

    Imf::InputFile file((folder / "a.exr").c_str());
    const Imath::Box2i data = file.header().dataWindow();
    EXPECT_EQ(data.min, Imath::V2i(3, 2));
    EXPECT_EQ(data.max, Imath::V2i(7, 5));
    EXPECT_EQ(file.header().displayWindow().max, Imath::V2i(19, 9));
    EXPECT_EQ(file.header().typedAttribute<Imf::StringAttribute>("source").value(), "part.vdb");
    EXPECT_EQ(file.header().typedAttribute<Imf::StringAttribute>("view").value(), "iso");
    std::vector<float> values(5 * 4 * 4);
    Imf::FrameBuffer buffer;
    std::size_t c = 0;
    for (const char* name : {"R", "G", "B", "A"}) {
        ASSERT_TRUE(file.header().channels().findChannel(name)) << name;
        buffer.insert(
            name, Imf::Slice::Make(Imf::FLOAT, values.data() + c++, data, 4 * sizeof(float), 5 * 4 * sizeof(float)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(2, 5);
    for (std::size_t i = 0; i < film.pixels().size(); ++i) {
        for (int k = 0; k < 3; ++k) EXPECT_EQ(values[4 * i + static_cast<std::size_t>(k)], film.pixels()[i].rgb[k]);
        EXPECT_EQ(values[4 * i + 3], 0.25f);
    }
}

TEST(WriteExr, RefusesWhatItCanNotWrite) {
    const test::ScratchFolder folder;
    const shade::Film film(1, 1, {0, 0, 1, 1});
    EXPECT_THROW(shade::writeExr(folder / "none/a.exr", film, {}), OutputError);
    EXPECT_THROW(shade::writeExr(folder / "a.exr", film, {{"dataWindow", "x"}}), std::invalid_argument);
    EXPECT_THROW(shade::writeExr(folder / "a.exr", film, {{"", "x"}}), std::invalid_argument);
}

}  // namespace
}  // namespace stratum
