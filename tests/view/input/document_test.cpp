#include "view/input/document.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "view/given_tile.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <string>
#include <vector>

namespace stratum::view {
namespace {

TEST(Document, ASceneIsReadAgainWhenItsFilesHaveChanged) {
    GivenInput given = test::givenTile(0.2);
    int reads = 0;
    given.again = [&reads, tile = given] {
        if (++reads == 2) throw InputError("scene.json: no JSON");
        GivenInput other = tile;
        other.options.scene.brdf = "pla-blue";
        return other;
    };
    Document document(given);
    document.update();
    EXPECT_EQ(reads, 0);  // it is as it was given
    const std::uint64_t generation = document.generation();
    document.forget();
    EXPECT_NE(document.generation(), generation);
    document.update();
    EXPECT_EQ(document.given().options.scene.brdf, "pla-blue");
    document.forget();
    EXPECT_THROW(document.update(), InputError);
    EXPECT_EQ(document.given().options.scene.brdf, "pla-blue");
    document.update();  // it is good again
    EXPECT_EQ(reads, 3);
}

TEST(Document, ABadSceneIsReadWhenItIsGood) {
    GivenInput given;
    given.path = "scene.json";
    given.again = [] { return test::givenTile(0.2); };
    Document document(given);
    EXPECT_EQ(document.files(), std::vector<std::string>{"scene.json"});
    document.update();
    EXPECT_EQ(document.given().objects.size(), 1U);
}

// Reading it would wait for a writer that never comes.
TEST(Document, ASceneThatNamesAPipeIsRefused) {
    const test::ScratchFolder folder;
    const std::string pipe = (folder / "part.gcode").string();
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    GivenInput given;
    given.path = "scene.json";
    given.again = [&pipe] {
        GivenInput now = test::givenTile(0.2);
        now.objects.front().vdb = pipe;
        return now;
    };
    Document document(given);
    EXPECT_THROW(document.update(), InputError);
    EXPECT_THROW(document.update(), InputError);
}

TEST(Document, DependsOnAllFilesThatItNames) {
    GivenInput given = test::givenTile(0.2);
    given.options.scene.env = "light.hdr";
    given.options.scene.brdf = "own.bsdf";
    given.objects.front().material.each["1"] = "other.bsdf";
    const std::vector<std::string> files = Document(given).files();
    for (const char* name : {"light.hdr", "own.bsdf", "other.bsdf"})
        EXPECT_NE(std::find(files.begin(), files.end(), name), files.end()) << name;
    given.options.scene.env = "studio";
    given.options.scene.brdf = "lambert:0.5,0.5,0.5";
    given.objects.front().material.each.clear();
    EXPECT_EQ(Document(given).files(), std::vector<std::string>{given.path});
}

// A page that meets another server, or another of its inputs, must see that.
TEST(Document, NoTwoHaveOneGeneration) {
    EXPECT_NE(Document(test::givenTile(0.2)).generation(), Document(test::givenTile(0.2)).generation());
    EXPECT_LT(Document(test::givenTile(0.2)).generation(), std::uint64_t{1} << 53);
}

}  // namespace
}  // namespace stratum::view
