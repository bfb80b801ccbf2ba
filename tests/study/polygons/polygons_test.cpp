#include "study/polygons/polygons.h"

#include "base/error.h"
#include "corpus.h"
#include "scratch_folder.h"
#include "study/polygons/mesh_intersector.h"
#include "study/polygons/print_rows.h"

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
PeerTracers meshPeer() {
    PeerTracers peers;
    peers.mesh = [](const TriangleMesh& mesh) { return Traced{makeMeshIntersector(mesh), mesh.triangles.size()}; };
    return peers;
}

TEST(Polygons, MeasuresAScene) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    common.quick = true;
    PolygonsOptions options;
    options.scenes = {(test::dataDir() / "scenes" / "roukema_2.json").string(),
                      (test::dataDir() / "scenes" / "roukema_3.json").string()};
    const StudyReport report = studyPolygons(options, {}, common);
    EXPECT_EQ(report.findings.size(), 1U);  // who is missing
    auto rows = rowsOf(folder.path() / "polygons_scenes.csv", 3);
    // Of the last scene, a cylinder: formula and level set agree, 10 corners do not, 50 nearly.
    const auto off = [&](const char* name) { return std::stod(rows.at(name).at(11)); };
    EXPECT_EQ(off("SDF, by formula"), 0);
    EXPECT_LT(off("level set, brick"), 0.02);
    EXPECT_GT(off("low mesh, every triangle"), 0.04);
    EXPECT_LT(off("high mesh, every triangle"), 0.01);
    EXPECT_EQ(rows.count("low mesh, Embree"), 0U);
    // With a peer the missing rows are added, the others kept.
    const StudyReport more = studyPolygons(options, meshPeer(), common);
    EXPECT_EQ(more.resumed, report.rows);
    EXPECT_GT(more.rows, report.rows);
    EXPECT_TRUE(more.findings.empty());
    rows = rowsOf(folder.path() / "polygons_scenes.csv", 3);
    EXPECT_EQ(off("low mesh, Embree"), off("low mesh, every triangle"));
}

TEST(Polygons, MeasuresAFolderOfPrints) {
    const test::ScratchFolder folder;
    const test::ScratchFolder prints;
    std::filesystem::copy(test::dataDir() / "gcode" / "tile.gcode", prints.path() / "tile.gcode");
    StudyOptions common;
    common.folder = folder.path();
    common.quick = true;
    PolygonsOptions options;
    options.prints = {prints.path().string()};
    common.threads = 2;
    options.integrators = {"ao"};  // path tracing tabulates its material for each row
    const StudyReport report = studyPolygons(options, {}, common);
    EXPECT_EQ(report.rows, 4U);  // two voxels a layer, and four, whole and on demand
    const auto rows = rowsOf(folder.path() / "polygons_prints.csv", kKind);
    const Row& whole = rows.at("level set");
    const Row& on_demand = rows.at("level set on demand");
    EXPECT_NEAR(valueOf(whole, kEnclosed), 0.71, 0.05);
    EXPECT_EQ(whole[kRays], on_demand[kRays]) << "rays of the same picture";
    for (const Row& row : {whole, on_demand}) {
        EXPECT_GT(valueOf(row, kRender), 0);
        EXPECT_GT(valueOf(row, kFirstLook), valueOf(row, kRender) / 4) << "one sample of four, and more";
        EXPECT_EQ(row[kThreads], "2");
        EXPECT_EQ(row[kIntegrator], "ao");
        EXPECT_EQ(row[kLight], "none");
    }
    // One primary ray a sample and at most one more.
    EXPECT_LE(valueOf(whole, kRays), 2 * 64 * 48 * 4);
    EXPECT_TRUE(std::filesystem::exists(report.html));
    EXPECT_EQ(studyPolygons(options, {}, common).resumed, 4U);
    options.integrators = {"normal"};
    EXPECT_THROW(studyPolygons(options, {}, common), UsageError);
}

// Rows as they might have been measured: a level set that takes long to make and is quick to look at, and a peer.
Row measured(const char* kind, double convert, double render, double look, double noise, double bias) {
    Row row(kSeries + 1);
    row[kKind] = kind;
    row[kSpp] = "32";
    row[kRead] = "0.5";
    row[kPrimitives] = row[kBytes] = row[kPeak] = row[kRays] = row[kExtruded] = "1";
    const auto set = [&row](double value, PrintColumn cpu, PrintColumn wall) {
        row[cpu] = row[wall] = std::to_string(value);
    };
    set(convert, kConvert, kConvertWall);
    set(0, kBuild, kBuildWall);
    set(render, kRender, kRenderWall);
    set(look, kFirstLook, kFirstLookWall);
    row[kNoise] = std::to_string(noise);
    row[kBias] = std::to_string(bias);
    return row;
}

TEST(Polygons, TellsWhereALevelSetIsAhead) {
    PrintResult print;
    print.name = "block";
    print.enclosed = 99.6;  // a model of 100 that was sliced
    // From 3.2 + n / 10 to 1 + n / 2: 2.2 seconds of making, paid back at 0.4 a sample, so ahead from 5.5 samples on.
    print.rows = {measured("level set", 3.2, 3.2, 3.3, 0.01, 0.001), measured("beads, 8:1", 1, 16, 1.5, 0.01, 0),
                  measured("4-gons, 8:1", 0.5, 8, 0.75, 0.01, 0.1)};
    EXPECT_EQ((*print.best(false, 32))[kKind], "beads, 8:1") << "the prisms' bias is above their noise";
    EXPECT_EQ((*print.best(false, 1))[kKind], "4-gons, 8:1") << "of one sample it is not";
    StudyReport report;
    Page page("", {});
    addPrints(page, {"ao", "ambient occlusion"}, {print}, {"level set"}, report);
    const std::string html = page.html();
    ASSERT_EQ(report.findings.size(), 2U);
    EXPECT_NE(report.findings[0].find("below noise: 1 of 1"), std::string::npos) << report.findings[0];
    EXPECT_NE(report.findings[1].find("best peer: 0 of 1"), std::string::npos) << report.findings[1];
    EXPECT_NE(html.find("2.66"), std::string::npos) << "(1 + 16) / (3.2 + 3.2)";
    EXPECT_NE(html.find("from 6 spp"), std::string::npos);
    EXPECT_NE(html.find("0.23"), std::string::npos) << "0.75 / 3.3";
    EXPECT_NE(html.find("slower"), std::string::npos);
}

TEST(Polygons, SaysNothingOfWhatWasNotMeasured) {
    PrintResult print;
    print.enclosed = 250;
    print.rows = {measured("level set", 1, 3.2, 0, 0.01, 0), measured("beads, 8:1", 1, 16, 0, 0.01, 0)};
    for (Row& row : print.rows) row[kFirstLook] = row[kFirstLookWall] = "";
    EXPECT_EQ(print.best(true, 1), nullptr);
    StudyReport report;
    Page page("", {});
    addPrints(page, {"path", "path tracing"}, {print}, {"level set"}, report);
    EXPECT_EQ(report.findings.size(), 1U);
    print.enclosed = 98;
    report.findings.clear();
    addPrints(page, {"path", "path tracing"}, {print}, {"level set"}, report);
    EXPECT_TRUE(report.findings.empty()) << "the aims are for large prints";
}

TEST(Polygons, SaysWhatItNeeds) {
    const test::ScratchFolder folder;
    StudyOptions common;
    common.folder = folder.path();
    EXPECT_THROW(studyPolygons({}, {}, common), UsageError);
    PolygonsOptions empty;
    empty.prints = {folder.path().string()};
    EXPECT_THROW(studyPolygons(empty, {}, common), InputError);
}

}  // namespace
}  // namespace stratum::study
