#include "march/file/level_set_file.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "spheres.h"

#include <gtest/gtest.h>

#include <fstream>

namespace stratum::march {
namespace {

class LevelSetFile : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    test::ScratchFolder folder_;

    std::filesystem::path write(const openvdb::GridCPtrVec& grids) {
        const auto path = folder_ / "grids.vdb";
        openvdb::io::File file(path.string());
        file.write(grids);
        return path;
    }

    static openvdb::FloatGrid::Ptr named(const char* name, float radius = 2) {
        auto grid = test::sphereGrid(radius, openvdb::Vec3f(0), 0.2f);
        grid->setName(name);
        return grid;
    }

    // The error's text, which must carry the place and the remedy.
    static std::string refusal(const std::filesystem::path& path, const std::string& name = "") {
        return test::messageOf<InputError>([&] { readLevelSet(path, name); }, "(no error)");
    }
};

TEST_F(LevelSetFile, TakesSurfaceAmongMany) {
    const auto path = write({named("other"), named("surface", 3), openvdb::Int32Grid::create()});
    EXPECT_EQ(readLevelSet(path)->getName(), "surface");
    EXPECT_EQ(readLevelSet(path, "other")->getName(), "other");
}

TEST_F(LevelSetFile, TakesTheOnlyLevelSetWhateverItsName) {
    EXPECT_EQ(readLevelSet(write({named("ls_bunny"), openvdb::Int32Grid::create()}))->getName(), "ls_bunny");
}

TEST_F(LevelSetFile, AsksWhichOfSeveral) {
    const std::string text = refusal(write({named("a"), named("b")}));
    EXPECT_NE(text.find("--grid"), std::string::npos) << text;
    EXPECT_NE(text.find("a (Tree_float_5_4_3)"), std::string::npos) << text;
}

TEST_F(LevelSetFile, RefusesFilesWithoutALevelSet) {
    const auto fog = named("density");
    fog->setGridClass(openvdb::GRID_FOG_VOLUME);
    EXPECT_NE(refusal(write({fog})).find("no level set"), std::string::npos);
    EXPECT_NE(refusal(write({fog}), "density").find("not a level set"), std::string::npos);
    EXPECT_NE(refusal(write({named("surface")}), "missing").find("no grid named missing"), std::string::npos);
    EXPECT_NE(refusal(write({openvdb::Int32Grid::create()})).find("no level set"), std::string::npos);
}

TEST_F(LevelSetFile, RefusesTwoGridsOfOneName) {
    EXPECT_NE(refusal(write({named("surface"), named("surface", 3)})).find("two grids named surface"),
              std::string::npos);
    EXPECT_NE(refusal(write({named("a"), named("a", 3), named("b")}), "a").find("two grids named a"),
              std::string::npos);
    EXPECT_EQ(readLevelSet(write({named("a"), named("a", 3), named("b")}), "b")->getName(), "b");
}

TEST_F(LevelSetFile, RefusesDamage) {
    EXPECT_NE(refusal("/nonexistent.vdb").find("not a file"), std::string::npos);
    const auto path = write({named("surface", 5)});
    const auto size = std::filesystem::file_size(path);
    for (const double share : {0.0, 0.01, 0.1, 0.5, 0.9, 0.99}) {
        const auto cut = folder_ / "cut.vdb";
        std::filesystem::copy_file(path, cut, std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(share * static_cast<double>(size)));
        EXPECT_NE(refusal(cut).find("cut.vdb"), std::string::npos) << share;
    }
    const auto text = folder_ / "text.vdb";
    std::ofstream(text) << "solid this is no vdb\n";
    EXPECT_NE(refusal(text).find("not a readable .vdb"), std::string::npos);
}

}  // namespace
}  // namespace stratum::march
