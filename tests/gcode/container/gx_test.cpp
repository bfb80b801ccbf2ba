#include "gcode/container/gx.h"

#include "base/error.h"
#include "gcode/container_samples.h"
#include "gcode/program.h"
#include "refusal.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::gcode {
namespace {

using sample::little;

std::string gxError(const std::string& bytes) {
    return test::messageOf<InputError>([&] { openGx(bytes, "a.gx"); }, "no error");
}

TEST(Gx, TheTextStaysAView) {
    const std::string text = sample::program(5);
    const std::string file = sample::gx(text, 1234);
    const Program program = openGx(file, "a");
    EXPECT_EQ(program.text, text);
    EXPECT_EQ(program.text.data() + text.size(), file.data() + file.size());
    EXPECT_EQ(program.unpacked.size(), 0U);
    EXPECT_DOUBLE_EQ(program.filament_mm.value(), 1234);
    const Toolpath toolpath = readProgram(sample::gx(text));
    EXPECT_EQ(toolpath.format, "gx");
    EXPECT_TRUE(sample::samePrint(toolpath, readProgram(text)));
}

TEST(Gx, ASecondThumbnailAsPng) {
    const std::string text = sample::program(2);
    std::string file = sample::gx("", 0);
    const std::size_t at = file.size();
    file += "\x89PNG\r\n....IEND\xae\x42\x60\x82";
    file.replace(0x18, 4, little(file.size(), 4));
    file.replace(0x14, 4, little(at, 4));
    EXPECT_EQ(openGx(file + text, "a").text, text);
}

TEST(Gx, OffsetsThatCantBe) {
    const std::string text = sample::program(5);
    const std::string file = sample::gx(text);
    EXPECT_NE(gxError(file.substr(0, 40)).find("ends after 40"), std::string::npos);
    for (const std::size_t offset : {std::size_t{0}, std::size_t{57}, file.size(), std::size_t{0xffffffff}}) {
        std::string bad = file;
        bad.replace(0x18, 4, little(offset, 4));
        EXPECT_NE(gxError(bad).find("byte 24"), std::string::npos) << offset;
    }
    // In the midst of the text a part of the print would be lost.
    for (const std::size_t more : {1U, 64U, 256U, 1024U}) {
        std::string bad = file;
        bad.replace(0x18, 4, little(file.size() - text.size() + more, 4));
        if (more >= 64) {
            EXPECT_NE(gxError(bad).find("in the midst"), std::string::npos) << more;
        }
    }
}

}  // namespace
}  // namespace stratum::gcode
