#include "base/own_file.h"

#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace stratum {
namespace {

TEST(OwnFile, HasANameAndAVersion) {
    const test::ScratchFolder folder;
    const auto own = [&folder](const std::string& bytes) {
        std::ofstream(folder / "file", std::ios::binary) << bytes;
        return isOwnFile(folder / "file");
    };
    EXPECT_TRUE(own(std::string("comment by ") + kProgramMark));
    EXPECT_TRUE(own("<p>stratum 0.9.1</p>"));
    EXPECT_TRUE(own(std::string("Software\0vdbtrace 1.2", 21)));
    EXPECT_TRUE(own("{\"program\": \"gcode2vdb 2.0\"}"));
    EXPECT_TRUE(own("line,layer,feature,tool,object,x0,y0,z0,x1\n1,2"));
    EXPECT_FALSE(own("the Stratum of rock"));
    // Somebody else's notes, G-code and scene.
    EXPECT_FALSE(own("my notes: made with gcode2vdb 0.2.0, do not lose"));
    EXPECT_FALSE(own("; filament_settings_id = \"Stratum 3D PLA\"\nG1 X1\n"));
    EXPECT_FALSE(own("{ /* checked with vdbtrace 0.2.0 */ \"print\": \"t.vdb\" }"));
    EXPECT_FALSE(own("written by gcode2vdb "));
    EXPECT_FALSE(own("solid by hand"));
    EXPECT_FALSE(own("layer,line\n"));
    EXPECT_FALSE(isOwnFile(folder / "none"));
    EXPECT_FALSE(isOwnFile(folder.path()));
}

TEST(OwnFile, AtItsBeginningOrItsEnd) {
    const test::ScratchFolder folder;
    const std::string much(3000000, 'x');
    const auto own = [&folder](const std::string& bytes) {
        std::ofstream(folder / "file", std::ios::binary) << bytes;
        return isOwnFile(folder / "file");
    };
    EXPECT_TRUE(own("by Stratum 1.0" + much));
    EXPECT_TRUE(own(much + "by Stratum 1.0"));
    EXPECT_FALSE(own(much + "by Stratum 1.0" + much));
}

}  // namespace
}  // namespace stratum
