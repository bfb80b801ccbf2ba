#include "study/seeds.h"

#include "corpus.h"
#include "io/error.h"
#include "scratch_folder.h"
#include "study/mesh_intersector.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>

namespace stratum::study {
namespace {

std::map<std::string, Row> rowsOf(const std::filesystem::path& csv, std::size_t key) {
    std::ifstream file(csv);
    std::map<std::string, Row> rows;
    for (std::string line; std::getline(file, line);) {
        Row row = parseCsvLine(line);
        rows[row.at(key)] = std::move(row);
    }
    return rows;
}

// A stand-in for a hierarchy: slow, but the same triangles.
SeedPeers meshPeer() {
    SeedPeers peers;
    peers.mesh = [](const TriangleMesh& mesh) { return Traced{makeMeshIntersector(mesh), mesh.triangles.size()}; };
    return peers;
}

TEST(Seeds, MeasuresAScene) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    common.quick = true;
    SeedsOptions options;
    options.scenes = {(test::dataDir() / "scenes" / "roukema_2.json").string(),
                      (test::dataDir() / "scenes" / "roukema_3.json").string()};
    const StudyReport report = studySeeds(options, {}, common);
    EXPECT_EQ(report.findings.size(), 1U);  // who is missing
    auto rows = rowsOf(folder.path() / "seeds_scenes.csv", 3);
    // Of the last scene, a cylinder: formula and level set agree, 10 corners do not, 50 nearly.
    const auto off = [&](const char* name) { return std::stod(rows.at(name).at(11)); };
    EXPECT_EQ(off("SDF, by formula"), 0);
    EXPECT_LT(off("level set, brick"), 0.02);
    EXPECT_GT(off("low mesh, every triangle"), 0.04);
    EXPECT_LT(off("high mesh, every triangle"), 0.01);
    EXPECT_EQ(rows.count("low mesh, Embree"), 0U);
    // With a peer the missing rows are added, the others kept.
    const StudyReport more = studySeeds(options, meshPeer(), common);
    EXPECT_EQ(more.resumed, report.rows);
    EXPECT_GT(more.rows, report.rows);
    EXPECT_TRUE(more.findings.empty());
    rows = rowsOf(folder.path() / "seeds_scenes.csv", 3);
    EXPECT_EQ(off("low mesh, Embree"), off("low mesh, every triangle"));
}

TEST(Seeds, MeasuresAFolderOfPrints) {
    const test::ScratchFolder folder;
    const test::ScratchFolder prints;
    std::filesystem::copy(test::dataDir() / "gcode" / "tile.gcode", prints.path() / "tile.gcode");
    StudyOptions common;
    common.folder = folder.path();
    common.quick = true;
    SeedsOptions options;
    options.prints = {prints.path().string()};
    const StudyReport report = studySeeds(options, {}, common);
    EXPECT_EQ(report.rows, 4U);  // two voxels a layer, and four, kept and on demand
    const auto rows = rowsOf(folder.path() / "seeds_prints.csv", 5);
    const Row row = rows.at("level set");
    EXPECT_NEAR(std::stod(row.at(7)), 0.71, 0.05);  // cm3 enclosed
    EXPECT_GT(std::stod(row.at(14)), 0);
    EXPECT_EQ(row.at(18), rows.at("level set on demand").at(18)) << "rays of the same picture";
    EXPECT_TRUE(std::filesystem::exists(report.html));
    EXPECT_EQ(studySeeds(options, {}, common).resumed, 4U);
}

TEST(Seeds, SaysWhatItNeeds) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    EXPECT_THROW(studySeeds({}, {}, common), UsageError);
    SeedsOptions empty;
    empty.prints = {folder.path().string()};
    EXPECT_THROW(studySeeds(empty, {}, common), InputError);
}

}  // namespace
}  // namespace stratum::study
