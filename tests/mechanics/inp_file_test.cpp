#include "mechanics/inp_file.h"

#include "scratch_folder.h"
#include "toolpaths.h"

#include "base/error.h"
#include "mechanics/element_sets.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace stratum::mechanics {
namespace {

namespace fs = std::filesystem;

// Two layers: along x by tool 0, along y by tool 1.
gcode::Toolpath twoLayers() {
    gcode::Toolpath toolpath;
    for (int n = 0; n < 4; ++n) test::addBead(toolpath, 0, 0.35 * n, 0.2, 2, 0.35 * n, 0.2, 0.4, 0.2);
    for (int n = 0; n < 5; ++n) test::addBead(toolpath, 0.4 * n, 0, 0.4, 0.4 * n, 1, 0.4, 0.4, 0.2, 2);
    toolpath.runs.back().tool = 1;
    toolpath.runs.back().feature = gcode::Feature::external_perimeter;
    for (std::size_t n = 5; n < toolpath.beads.size(); ++n) toolpath.beads[n].run = toolpath.beads[4].run;
    return toolpath;
}

voxelize::Lattice lattice(double voxel) {
    voxelize::Lattice lattice;
    lattice.voxel_size = voxel;
    lattice.layer_height = 0.2;
    return lattice;
}

struct Made {
    gcode::Toolpath toolpath = twoLayers();
    SolidElements elements = solidElements(toolpath, test::allBeads(toolpath), lattice(0.1));
    Hexahedra mesh = hexahedraOf(elements, 1000000);
};

// Keyword lines with the lines of data below them.
struct Block {
    std::string keyword;
    std::vector<std::vector<double>> lines;
};
std::vector<Block> blocksOf(const fs::path& path) {
    std::vector<Block> blocks;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (line.starts_with("**")) continue;
        if (line.starts_with('*')) {
            blocks.push_back({line, {}});
            continue;
        }
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream words(line);
        std::vector<double> numbers;
        for (double n = 0; words >> n;) numbers.push_back(n);
        blocks.back().lines.push_back(numbers);
    }
    return blocks;
}

std::set<std::uint32_t> membersOf(const NamedSet& set) {
    std::set<std::uint32_t> members;
    for (const NumberRange& range : set.members)
        for (std::uint32_t n = range.first; n <= range.last; ++n) members.insert(n);
    return members;
}

TEST(ElementSets, AreOfTheNearestBead) {
    const Made made;
    std::map<std::string, std::set<std::uint32_t>> sets;
    for (const NamedSet& set : elementSets(made.elements, made.toolpath)) sets[set.name] = membersOf(set);
    EXPECT_EQ(sets.size(), 6U);
    EXPECT_EQ(sets["LAYER_2"], sets["TOOL_1"]);
    EXPECT_EQ(sets["LAYER_2"], sets["FEATURE_EXTERNAL_PERIMETER"]);
    for (std::uint32_t n = 0; n < made.elements.list.size(); ++n) {
        const bool upper = made.elements.origin[2] + (made.elements.list[n].k + 0.5) * 0.1 > 0.2;
        EXPECT_EQ(sets["LAYER_2"].count(n), upper ? 1U : 0U);
        EXPECT_EQ(sets["LAYER_1"].count(n), upper ? 0U : 1U);
    }
}

TEST(ElementSets, NodesAreThoseOfTheElements) {
    const Made made;
    std::map<std::string, std::set<std::uint32_t>> nodes;
    for (const NamedSet& set : nodeSets(made.elements, made.mesh, made.toolpath)) nodes[set.name] = membersOf(set);
    for (const NamedSet& set : elementSets(made.elements, made.toolpath)) {
        std::set<std::uint32_t> expected;
        for (const std::uint32_t e : membersOf(set))
            expected.insert(made.mesh.corners[e].begin(), made.mesh.corners[e].end());
        EXPECT_EQ(nodes[set.name], expected) << set.name;
    }
    for (const std::uint32_t n : nodes["BED"])
        EXPECT_NEAR(made.elements.origin[2] + made.mesh.nodes[n].k * 0.1, 0, 1e-9);
    for (const std::uint32_t n : nodes["TOP"])
        EXPECT_NEAR(made.elements.origin[2] + made.mesh.nodes[n].k * 0.1, 0.4, 1e-9);
    EXPECT_FALSE(nodes["XMIN"].empty());
}

TEST(InpFile, WritesConstantsAsTheyWereGiven) {
    const test::ScratchFolder folder;
    const Made made;
    InpOptions options;
    options.source = "a\n*STEP.gcode";
    options.elastic = parseElastic("3500,0.4999999");
    writeInp(made.elements, made.mesh, made.toolpath, options, folder.path() / "a.inp");
    const std::string text = test::bytesOf(folder.path() / "a.inp");
    EXPECT_NE(text.find("\n3500, 0.4999999\n"), std::string::npos);
    EXPECT_EQ(text.find("\n*STEP"), std::string::npos);
}

TEST(InpFile, HasNodesElementsAndSets) {
    const test::ScratchFolder folder;
    const Made made;
    InpOptions options;
    options.placement.offset[0] = 10;
    options.elastic = parseElastic("3400,3000,2800,0.35,0.34,0.4,1200,1100,1000");
    const InpReport report = writeInp(made.elements, made.mesh, made.toolpath, options, folder.path() / "a.inp");
    EXPECT_EQ(report.directions, 2U);
    std::size_t elements = 0;
    std::map<std::string, std::size_t> members;
    for (const Block& block : blocksOf(folder.path() / "a.inp")) {
        if (block.keyword.starts_with("*NODE,")) {
            ASSERT_EQ(block.lines.size(), made.mesh.nodes.size());
            for (std::size_t n = 0; n < block.lines.size(); ++n) {
                EXPECT_EQ(block.lines[n][0], static_cast<double>(n + 1));
                EXPECT_NEAR(block.lines[n][1], 10 + made.elements.origin[0] + 0.1 * made.mesh.nodes[n].i, 1e-6);
                EXPECT_NEAR(block.lines[n][3], made.elements.origin[2] + 0.1 * made.mesh.nodes[n].k, 1e-6);
            }
        }
        if (block.keyword.starts_with("*ELEMENT,")) {
            elements = block.lines.size();
            for (std::size_t n = 0; n < elements; ++n)
                for (std::size_t c = 0; c < 8; ++c) EXPECT_EQ(block.lines[n][c + 1], made.mesh.corners[n][c] + 1.0);
        }
        for (const auto& line : block.lines)
            if (block.keyword.find("GENERATE") != std::string::npos)
                members[block.keyword] += static_cast<std::size_t>(line[1] - line[0]) + 1;
    }
    EXPECT_EQ(elements, made.elements.list.size());
    EXPECT_EQ(members["*ELSET, ELSET=LAYER_1, GENERATE"] + members["*ELSET, ELSET=LAYER_2, GENERATE"], elements);
    EXPECT_EQ(members["*ELSET, ELSET=ALONG_0, GENERATE"] + members["*ELSET, ELSET=ALONG_90, GENERATE"], elements);
}

TEST(InpFile, OfAPrintOnABeltLiesInTheWorld) {
    const test::ScratchFolder folder;
    Made made;
    made.toolpath.belt_angle = 45;
    InpOptions options;
    options.placement.offset[2] = 3;
    options.placement.tilt = 45;
    options.elastic = parseElastic("3400,3000,2800,0.35,0.34,0.4,1200,1100,1000");
    writeInp(made.elements, made.mesh, made.toolpath, options, folder.path() / "a.inp");
    const double half = std::sqrt(0.5);
    bool along_y = false;
    for (const Block& block : blocksOf(folder.path() / "a.inp")) {
        if (block.keyword.starts_with("*NODE,"))
            for (std::size_t n = 0; n < block.lines.size(); ++n) {
                const double y = made.elements.origin[1] + 0.1 * made.mesh.nodes[n].j;
                const double z = made.elements.origin[2] + 0.1 * made.mesh.nodes[n].k;
                EXPECT_NEAR(block.lines[n][2], half * (y - z), 1e-6);
                EXPECT_NEAR(block.lines[n][3], half * (y + z) + 3, 1e-6);
            }
        if (!block.keyword.starts_with("*ORIENTATION, NAME=ALONG_90,")) continue;
        along_y = true;
        const std::vector<double> axes{0, half, half, -1, 0, 0};
        ASSERT_EQ(block.lines.at(0).size(), axes.size());
        for (std::size_t n = 0; n < axes.size(); ++n) EXPECT_NEAR(block.lines[0][n], axes[n], 1e-6);
    }
    EXPECT_TRUE(along_y);
    for (const NamedSet& set : nodeSets(made.elements, made.mesh, made.toolpath)) EXPECT_NE(set.name, "BED");
}

TEST(InpFile, HasTheSameBytesForAnyNumberOfThreads) {
    const test::ScratchFolder folder;
    const auto bytes = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        const Made made;
        writeInp(made.elements, made.mesh, made.toolpath, {}, folder.path() / "a.inp");
        return test::bytesOf(folder / "a.inp");
    };
    EXPECT_EQ(bytes(1), bytes(4));
}

TEST(InpFile, OfNothingIsRefusedAndTheOldOneStays) {
    const test::ScratchFolder folder;
    const fs::path path = folder.path() / "a.inp";
    std::ofstream(path) << "old";
    SolidElements none;
    none.edge = 0.4;
    EXPECT_THROW(writeInp(none, {}, {}, {}, path), UsageError);
    std::string text;
    std::ifstream(path) >> text;
    EXPECT_EQ(text, "old");
}

}  // namespace
}  // namespace stratum::mechanics
