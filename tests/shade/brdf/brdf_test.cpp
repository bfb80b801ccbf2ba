
#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "shade/brdf_checks.h"
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

// What a coat reflects more at grazing angles is not less than what it takes from the body: no bead has a dark rim.
TEST(MakeBrdf, TablesOfTheProjectAreNotDarkAtGrazingAngles) {
    for (const char* name :
         {"pla-blue", "pla-green", "pla-red", "pla-white", "pla-yellow", "petg-black", "petg-orange", "silk-pink"}) {
        const auto brdf = makeBrdf(name);
        double before = 0.97 * test::sampledAlbedo(*brdf, test::direction(1.0, 0.0));
        for (const double cosine : {0.7, 0.5, 0.3, 0.1, 0.05}) {
            const double albedo = test::sampledAlbedo(*brdf, test::direction(cosine, 0.0));
            EXPECT_GT(albedo, before) << name << " " << cosine;
            EXPECT_LT(albedo, 1.0) << name << " " << cosine;
            before = 0.97 * albedo;
        }
    }
}

TEST(MakeBrdf, GuessesMistypedNames) {
    for (const auto& [wrong, right] : {std::pair("pla-bleu", "pla-blue"), std::pair("plastik:1,1,1,1", "plastic")}) {
        EXPECT_TRUE(
            test::refuses<UsageError>(std::string("did you mean '") + right, [name = wrong] { makeBrdf(name); }));
    }
}

}  // namespace
}  // namespace stratum
