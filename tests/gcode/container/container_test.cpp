#include "gcode/container/container.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/container_samples.h"
#include "gcode/program.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

TEST(Container, ContentDecidesNotTheName) {
    const std::string text = sample::program(3);
    const std::pair<const char*, std::string> files[] = {
        {"ascii", text},
        {"gzip", sample::gzip(text)},
        {"bgcode", sample::bgcode(text, 3, 2)},
        {"3mf", sample::zip({{"Metadata/plate_1.gcode", text}})},
        {"ufp", sample::ufp(text)},
        {"gx", sample::gx(text)},
    };
    for (const auto& [format, file] : files) {
        const Program program = openContainer(file, "part.stl");
        EXPECT_EQ(program.format, format);
        EXPECT_TRUE(program.text.starts_with(text)) << format;
        EXPECT_EQ(readProgram(file).format, format);
        EXPECT_TRUE(sample::samePrint(readProgram(file), readProgram(text))) << format;
    }
}

TEST(Container, PlainTextIsNotCopied) {
    const std::string text = sample::program(1);
    const Program program = openContainer(text, "a");
    EXPECT_EQ(program.text.data(), text.data());
    EXPECT_EQ(program.unpacked.size(), 0U);
}

TEST(Container, SurvivesAMove) {
    const std::string text = sample::program(3);
    const std::string file = sample::gzip(text);
    Program first = openContainer(file, "a");
    const Program second = std::move(first);
    EXPECT_EQ(second.text, text);
}

TEST(Container, NoneInsideAnother) {
    const std::string inner = sample::gzip(sample::program(3));
    EXPECT_NE(inputErrorOf(sample::gzip(inner)).find("unpack the outer one first"), std::string::npos);
    EXPECT_NE(inputErrorOf(sample::gzip(sample::bgcode("G1 X1 E1\n", 0, 0))).find("bgcode"), std::string::npos);
    EXPECT_NE(inputErrorOf(sample::gzip("")).find("empty"), std::string::npos);
}

TEST(Container, Limits) {
    const ContainerLimits limits;
    EXPECT_EQ(limits.bytesFrom(10), std::size_t{64} << 20);
    EXPECT_EQ(limits.bytesFrom(1 << 20), std::size_t{200} << 20);
    EXPECT_EQ(limits.bytesFrom(std::size_t{1} << 40), std::size_t{4} << 30);
    EXPECT_EQ(limits.bytesFrom(~std::size_t{0}), std::size_t{4} << 30);
}

TEST(Container, TheCorpusGzip) {
    STRATUM_NEEDS_CORPUS(path, "gcode/spot_1000cc_0.1mm_grid.gcode.gz");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "spot");
    EXPECT_EQ(toolpath.format, "gzip");
    EXPECT_NEAR(toolpath.filament_mm, 64723.70, 0.001 * 64723.70);
    EXPECT_EQ(toolpath.layer_count, 1886U);
}

}  // namespace
}  // namespace stratum::gcode
