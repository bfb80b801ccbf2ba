#include "gcode/container/zip_archive.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/container_samples.h"
#include "gcode/program.h"
#include "refusal.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

namespace stratum::gcode {
namespace {

template <typename Error>
std::string zipError(const std::string& bytes, std::optional<int> plate = {}, const ContainerLimits& limits = {}) {
    return test::messageOf<Error>([&] { openZip(bytes, "a.zip", plate, limits); }, "no error");
}

TEST(ZipContainer, TheOnlyPlate) {
    const std::string text = sample::program(3);
    const std::string file = sample::zip({{"[Content_Types].xml", "<x/>"},
                                          {"3D/3dmodel.model", "<model/>"},
                                          {"Metadata/plate_1.gcode.md5", "0"},
                                          {"Metadata/plate_7.gcode", text}});
    const Program program = openZip(file, "a", {}, {});
    EXPECT_EQ(program.format, "3mf");
    EXPECT_EQ(program.text, text);
    EXPECT_EQ(openZip(file, "a", 7, {}).text, text);
    EXPECT_NE(zipError<UsageError>(file, 1).find("--plate 1: there is no such plate; it has 7"), std::string::npos);
    EXPECT_TRUE(sample::samePrint(readProgram(file), readProgram(text)));
}

TEST(ZipContainer, OneOfSeveralPlates) {
    const std::string text = sample::program(3);
    const std::string file = sample::zip({{"Metadata/plate_10.gcode", "G1 X10\n"},
                                          {"Metadata/plate_2.gcode", text},
                                          {"Metadata/plate_x.gcode", "no plate"}});
    EXPECT_NE(zipError<UsageError>(file).find("a.zip: has 2 plates (2, 10); choose one, e.g. --plate 2"),
              std::string::npos);
    EXPECT_EQ(openZip(file, "a", 10, {}).text, "G1 X10\n");
    ReadOptions options;
    options.plate = 2;
    EXPECT_EQ(readProgram(file, options).format, "3mf");
    EXPECT_THROW(readProgram(text, options), UsageError);
}

TEST(ZipContainer, Ufp) {
    const std::string text = sample::program(3);
    const std::string file = sample::ufp(text);
    EXPECT_EQ(openZip(file, "a", {}, {}).text, text);
    EXPECT_EQ(readProgram(file).format, "ufp");
}

TEST(ZipContainer, WithoutAProgram) {
    EXPECT_NE(zipError<InputError>(sample::zip({{"3D/3dmodel.model", "<model/>"}})).find("3MF model without G-code"),
              std::string::npos);
    EXPECT_NE(zipError<InputError>(sample::zip({{"a.txt", "a"}})).find("1 entries, none of them"), std::string::npos);
    EXPECT_NE(zipError<InputError>("PK\x03\x04 and nothing").find("can't be read"), std::string::npos);
}

TEST(ZipContainer, ABombIsStopped) {
    const std::string bomb = sample::ufp(std::string(std::size_t{9} << 20, 'G'));
    ContainerLimits limits;
    limits.any_ratio_bytes = 1 << 20;
    EXPECT_NE(zipError<InputError>(bomb, {}, limits).find("would unpack to 9437184"), std::string::npos);
}

TEST(ZipContainer, TheCorpusUfp) {
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode_metadata-cura_2ext.ufp");
    const InputFile file(path);
    const Toolpath toolpath = readToolpath(file.bytes(), "ufp");
    EXPECT_EQ(toolpath.format, "ufp");
    EXPECT_GT(toolpath.beads.size(), 5000U);
    EXPECT_GT(toolpath.layer_count, 10U);
}

}  // namespace
}  // namespace stratum::gcode
