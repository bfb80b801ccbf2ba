#include "study/polygons/polygons.h"

#include "base/error.h"
#include "corpus.h"
#include "scratch_folder.h"
#include "study/polygons/mesh_intersector.h"
#include "study/polygons/print_page.h"

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
    StudyOptions common{.folder = folder.path(), .quick = true};
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
    const StudyReport more = studyPolygons(options, meshPeer(), common);
    EXPECT_GT(more.rows, report.rows);
    EXPECT_TRUE(more.findings.empty());
    rows = rowsOf(folder.path() / "polygons_scenes.csv", 3);
    EXPECT_EQ(off("low mesh, Embree"), off("low mesh, every triangle"));
}

TEST(Polygons, MeasuresAFolderOfPrints) {
    const test::ScratchFolder folder;
    const test::ScratchFolder prints;
    std::filesystem::copy(test::dataDir() / "gcode" / "tile.gcode", prints.path() / "tile.gcode");
    StudyOptions common{.folder = folder.path(), .quick = true};
    PolygonsOptions options;
    options.prints = {prints.path().string()};
    common.threads = 2;
    options.integrators = {"ao"};  // path tracing tabulates its material for each row
    const StudyReport report = studyPolygons(options, {}, common);
    EXPECT_EQ(report.rows, 4U);  // two voxels a layer, and four, whole and on demand
    const Table columns(kPrintColumns);
    const auto rows = rowsOf(folder.path() / "polygons_prints.csv", 7);
    const Row& whole = rows.at("level set");
    const Row& on_demand = rows.at("level set on demand");
    EXPECT_NEAR(columns.number(whole, "enclosed_cm3"), 0.71, 0.05);
    EXPECT_EQ(columns.text(whole, "rays"), columns.text(on_demand, "rays")) << "rays of the same picture";
    for (const Row& row : {whole, on_demand}) {
        EXPECT_GT(columns.number(row, "render_cpu"), 0);
        EXPECT_GT(columns.number(row, "first_look_cpu"), columns.number(row, "render_cpu") / 4)
            << "one sample of four, and more";
        EXPECT_EQ(columns.text(row, "threads"), "2");
        EXPECT_EQ(columns.text(row, "integrator"), "ao");
        EXPECT_EQ(columns.text(row, "light"), "none");
    }
    // One primary ray a sample and at most one more.
    EXPECT_LE(columns.number(whole, "rays"), 2 * 64 * 48 * 4);
    EXPECT_TRUE(std::filesystem::exists(report.html));
    options.integrators = {"normal"};
    EXPECT_THROW(studyPolygons(options, {}, common), UsageError);
}

// Rows as they might have been measured: a level set that takes long to make and is quick to look at, and a peer.
Row measured(const char* kind, double enclosed, double convert, double render, const char* look, double noise,
             double bias) {
    const std::map<std::string, std::string> known{{"print", "block"},
                                                   {"integrator", "ao"},
                                                   {"representation", kind},
                                                   {"spp", "32"},
                                                   {"enclosed_cm3", std::to_string(enclosed)},
                                                   {"convert_cpu", std::to_string(convert)},
                                                   {"convert_wall", std::to_string(convert)},
                                                   {"render_cpu", std::to_string(render)},
                                                   {"render_wall", std::to_string(render)},
                                                   {"first_look_cpu", look},
                                                   {"first_look_wall", look},
                                                   {"noise", std::to_string(noise)},
                                                   {"bias", std::to_string(bias)}};
    Row row;
    for (const std::string& column : parseCsvLine(kPrintColumns))
        row.push_back(known.count(column) > 0 ? known.at(column) : "0");
    return row;
}

TEST(Polygons, TellsWhereALevelSetIsAhead) {
    Table table(kPrintColumns);
    constexpr double kVolume = 99.6;  // a model of 100 that was sliced
    // From 3.2 + n / 10 to 1 + n / 2: 2.2 seconds of making, paid back at 0.4 a sample, so ahead from 5.5 samples on.
    table.add(measured("level set", kVolume, 3.2, 3.2, "3.3", 0.01, 0.001));
    table.add(measured("beads, 8:1", kVolume, 1, 16, "1.5", 0.01, 0));
    table.add(measured("4-gons, 8:1", kVolume, 0.5, 8, "0.75", 0.01, 0.1));
    EXPECT_EQ(table.text(*bestOf(table, table.rows(), false, 32), "representation"), "beads, 8:1")
        << "the prisms' bias is above their noise";
    EXPECT_EQ(table.text(*bestOf(table, table.rows(), false, 1), "representation"), "4-gons, 8:1")
        << "of one sample it is not";
    StudyReport report;
    Page page("", {});
    addPrints(page, table, "ao", "ambient occlusion", report);
    const std::string html = page.html();
    ASSERT_EQ(report.findings.size(), 2U);
    EXPECT_NE(report.findings[0].find("best peer: 1 of 1"), std::string::npos) << report.findings[0];
    EXPECT_NE(report.findings[1].find("best peer: 0 of 1"), std::string::npos) << report.findings[1];
    EXPECT_NE(html.find("2.66"), std::string::npos) << "(1 + 16) / (3.2 + 3.2)";
    EXPECT_NE(html.find("from 6 spp"), std::string::npos);
    EXPECT_NE(html.find("0.23"), std::string::npos) << "0.75 / 3.3";
}

TEST(Polygons, SaysNothingOfWhatWasNotMeasured) {
    for (const double enclosed : {250.0, 98.0}) {
        Table table(kPrintColumns);
        table.add(measured("level set", enclosed, 1, 3.2, "", 0.01, 0));
        table.add(measured("beads, 8:1", enclosed, 1, 16, "", 0.01, 0));
        EXPECT_EQ(bestOf(table, table.rows(), true, 1), nullptr);
        StudyReport report;
        Page page("", {});
        addPrints(page, table, "ao", "ambient occlusion", report);
        EXPECT_EQ(report.findings.size(), enclosed > 100 ? 1U : 0U) << "only large prints count";
    }
}

TEST(Polygons, SaysWhatItNeeds) {
    const test::ScratchFolder folder;
    StudyOptions common{.folder = folder.path()};
    EXPECT_THROW(studyPolygons({}, {}, common), UsageError);
    PolygonsOptions empty;
    empty.prints = {folder.path().string()};
    EXPECT_THROW(studyPolygons(empty, {}, common), InputError);
}

}  // namespace
}  // namespace stratum::study
