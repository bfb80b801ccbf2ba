#include "gcode/toolpath/toolpath_csv.h"

#include "gcode/program.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

std::vector<std::string> linesOf(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
}

TEST(ToolpathCsv, OneRowABead) {
    const auto path = std::filesystem::path(testing::TempDir()) / "toolpath.csv";
    const Toolpath toolpath = readProgram(
        "M83\n;LAYER_CHANGE\n;HEIGHT:0.25\n;TYPE:External perimeter\nT1\nG1 Z.25 F1200\nG1 X10 E1\nG3 X10 Y4 J2 E.5\n");
    writeToolpathCsv(toolpath, path);
    const auto lines = linesOf(path);
    ASSERT_EQ(lines.size(), 3U);
    EXPECT_EQ(lines[0],
              "line,layer,feature,tool,object,x0,y0,z0,x1,y1,z1,center_x,center_y,sweep,width,height,length,volume,"
              "speed");
    EXPECT_TRUE(lines[1].starts_with("7,1,external-perimeter,1,0,0,0,0.25,10,0,0.25,,,,")) << lines[1];
    EXPECT_TRUE(lines[1].ends_with(",20")) << lines[1];
    EXPECT_TRUE(lines[2].starts_with("8,1,external-perimeter,1,0,10,0,0.25,10,4,0.25,10,2,3.14159")) << lines[2];
}

TEST(ToolpathCsv, AnUnwritablePlaceIsAnOutputError) {
    const Toolpath toolpath = readProgram("G1 X10 E1\n");
    EXPECT_THROW(writeToolpathCsv(toolpath, "/nonexistent/folder/a.csv"), OutputError);
}

}  // namespace
}  // namespace stratum::gcode
