
#include "base/error.h"
#include "scratch_folder.h"
#include "shade/finish/named_brdf.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

namespace stratum {
namespace {

using shade::makeBrdf;

TEST(MakeBrdf, ReadsPresets) {
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    EXPECT_NEAR(makeBrdf("lambert:0.1,0.5,1")->eval(up, up).g, 0.5f / 3.14159265f, 1e-6f);
    EXPECT_GT(makeBrdf("plastic:0,0,0,0.1")->eval(up, up).r, 0.1f);
    EXPECT_TRUE(makeBrdf(shade::kDefaultBrdf));
    EXPECT_EQ(makeBrdf("")->eval(up, up).r, makeBrdf(shade::kDefaultBrdf)->eval(up, up).r);
}

TEST(MakeBrdf, RefusesNonsense) {
    for (const char* text : {"lambert", "lambert:", "lambert:1,2", "lambert:0.1,0.2,1.5", "lambert:0.1,0.2,-0.1",
                             "lambert:a,b,c", "lambert:0.1,0.2,nan", "lambert:0.1,0.2,0.3,", "plastic:0.1,0.2,0.3",
                             "plastic:0.1,0.2,0.3,0", "plastic:0.1,0.2,0.3,2", "chrome:1,1,1"})
        EXPECT_THROW(makeBrdf(text), UsageError) << text;
}

TEST(MakeBrdf, TablesOfTheProjectComeBeforeFilesOfTheirNames) {
    const test::ScratchFolder folder;
    const test::WorkingFolder inside(folder.path());
    std::ofstream("pla-blue") << "no table";
    std::filesystem::create_directory("petg-orange");
    EXPECT_NO_THROW(makeBrdf("pla-blue"));
    EXPECT_NO_THROW(makeBrdf("petg-orange"));
    EXPECT_THROW(makeBrdf("./pla-blue"), InputError);
}

TEST(MakeBrdf, GuessesMistypedNames) {
    for (const auto& [wrong, right] : {std::pair("pla-bleu", "pla-blue"), std::pair("plastik:1,1,1,1", "plastic")}) {
        try {
            makeBrdf(wrong);
            ADD_FAILURE();
        } catch (const UsageError& error) {
            EXPECT_NE(std::string(error.what()).find(std::string("did you mean '") + right), std::string::npos)
                << error.what();
        }
    }
}

}  // namespace
}  // namespace stratum
