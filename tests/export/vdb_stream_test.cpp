#include "export/vdb_stream.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "scratch_folder.h"
#include "toolpaths.h"
#include "vdb_bytes.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>
#include <sstream>
#include <vector>

namespace stratum::exporter {
namespace {

namespace fs = std::filesystem;

class VdbStreamTest : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    voxelize::LeafStreamReport stream(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice,
                                      const voxelize::Placement& placement, const FileOptions& options,
                                      const fs::path& path, WrittenGrid* written = nullptr) {
        const std::vector<std::uint32_t> beads = test::allBeads(toolpath);
        voxelize::VoxelizeOptions voxelize_options;
        voxelize_options.placement = placement;
        voxelize_options.bytes_per_leaf = 0;
        voxelize::Voxelizer voxelizer(toolpath, beads, lattice, voxelize_options);
        const auto grid = voxelizer.emptyGrid();
        describe(*grid, lattice, provenance_);
        const voxelize::LeafBounds bounds = voxelizer.leafBounds();
        VdbStream file(grid, path, options, bounds);
        const auto report = voxelizer.stream(0xffffffff, bounds, file, true);
        const WrittenGrid all = file.finish();
        EXPECT_LE(all.leaves, bounds.leaves);
        if (written != nullptr) *written = all;
        return report;
    }

    // The stream's file against OpenVDB's of the grid in memory.
    void expectAsOpenVdb(const gcode::Toolpath& toolpath, const voxelize::Lattice& lattice,
                         const voxelize::Placement& placement, const FileOptions& options = {}) {
        const fs::path ours = folder_ / "ours.vdb";
        const fs::path theirs = folder_ / "theirs.vdb";
        WrittenGrid written;
        const auto report = stream(toolpath, lattice, placement, options, ours, &written);
        const std::vector<std::uint32_t> beads = test::allBeads(toolpath);
        voxelize::VoxelizeOptions voxelize_options;
        voxelize_options.placement = placement;
        const auto grid = voxelize::voxelize(toolpath, beads, lattice, voxelize_options);
        describe(*grid, lattice, provenance_);
        grid->setSaveFloatAsHalf(options.half);
        test::OpenVdbArchive::writeFile({grid}, theirs, compressionFlags(options.compression));
        test::expectSameContents(ours, theirs);
        // Room that was reserved before the leaves came, and is left.
        EXPECT_LE(static_cast<double>(fs::file_size(ours)), 1.01 * static_cast<double>(fs::file_size(theirs)) + 4096);
        EXPECT_EQ(written.leaves, grid->tree().leafCount());
        EXPECT_EQ(report.leaves, grid->tree().leafCount());
        EXPECT_EQ(written.statistics.active_voxels, grid->activeVoxelCount());
        EXPECT_EQ(written.statistics.memory_bytes, grid->memUsage());
        EXPECT_EQ(written.statistics.active_box, grid->evalActiveVoxelBoundingBox());
        const double enclosed = voxelize::enclosedVolume(*grid) / grid->transform().voxelVolume();
        EXPECT_NEAR(report.volume_voxels, enclosed, 0.04 * enclosed);
    }

    // Lines in layers of 0.2 mm, at random places of a square.
    static gcode::Toolpath randomLayers(unsigned seed, double size, int layers, int lines, double from = 0) {
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> place(from, from + size);
        gcode::Toolpath toolpath;
        for (int layer = 1; layer <= layers; ++layer)
            for (int n = 0; n < lines; ++n)
                test::addBead(toolpath, place(random), place(random), 0.2 * layer, place(random), place(random),
                              0.2 * layer, 0.45, 0.2);
        return toolpath;
    }

    static voxelize::Lattice latticeOf(double voxel_size) {
        voxelize::Lattice lattice;
        lattice.voxel_size = voxel_size;
        lattice.layer_height = 0.2;
        return lattice;
    }

    Provenance provenance_;
    test::ScratchFolder folder_;
};

TEST_F(VdbStreamTest, TreeHasTheBytesOfOpenVdbsWriter) {
    const gcode::Toolpath toolpath = randomLayers(1, 20, 8, 20);
    expectAsOpenVdb(toolpath, latticeOf(0.1), {});
    for (const Compression compression : {Compression::blosc, Compression::zip, Compression::none})
        for (const bool half : {false, true})
            expectAsOpenVdb(toolpath, latticeOf(0.15), {}, {.half = half, .compression = compression});
}

TEST_F(VdbStreamTest, EveryNodeAroundTheOriginIsInItsOrder) {
    // Four upper nodes below the bed, four above it.
    const gcode::Toolpath toolpath = randomLayers(2, 20, 6, 12, -10);
    expectAsOpenVdb(toolpath, latticeOf(0.1), {});
    voxelize::Placement placement;
    placement.offset[0] = 7;
    placement.up_y = true;
    placement.unit = 0.001;
    expectAsOpenVdb(toolpath, latticeOf(0.15), placement);
    // Lower and upper nodes end within the print.
    gcode::Toolpath moved;
    for (int n = 0; n < 12; ++n)
        test::addBead(moved, 40.3 + n, 40.2, 40.7 + 0.15 * n, 41.1 + n, 42.9, 40.7 + 0.15 * n, 0.4, 0.2);
    expectAsOpenVdb(moved, latticeOf(0.01), {});
}

// Nothing is reserved for what lies between them.
TEST_F(VdbStreamTest, TowersFarApart) {
    gcode::Toolpath toolpath;
    for (int layer = 1; layer <= 40; ++layer)
        for (const double x : {0.0, 250.0})
            for (int n = 0; n < 7; ++n)
                test::addBead(toolpath, x, x + 0.45 * n, 0.2 * layer, x + 3, x + 0.45 * n, 0.2 * layer, 0.45, 0.2);
    expectAsOpenVdb(toolpath, latticeOf(0.05), {});
}

TEST_F(VdbStreamTest, SectionsSettlingAndArcs) {
    gcode::Toolpath toolpath = randomLayers(3, 15, 5, 15);
    toolpath.deposit.beads = gcode::DepositModel::Beads::settled;
    toolpath.deposit.corner_fraction = 0.5;
    test::addArc(toolpath, 5, 5, 3, 0.5, 4, 0.6, 0.6, 0.45, 0.2);
    test::addBead(toolpath, 1, 1, 0.2, 9, 9, 3, 0.4, 0.4);  // sloped
    expectAsOpenVdb(toolpath, latticeOf(0.1), {});
}

TEST_F(VdbStreamTest, RealPrintsHaveTheSameBytes) {
    STRATUM_NEEDS_CORPUS(path, "gcode/gcode-preview-benchy_slic3r.gcode");
    const InputFile file(path);
    expectAsOpenVdb(gcode::readToolpath(file.bytes(), "benchy", {}), latticeOf(0.15), {});
}

TEST_F(VdbStreamTest, SameFileForAnyNumberOfThreads) {
    const gcode::Toolpath toolpath = randomLayers(4, 25, 6, 25);
    std::string files[3];
    const std::size_t threads[] = {1, 2, 7};
    for (int n = 0; n < 3; ++n) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads[n]);
        const fs::path path = folder_ / "print.vdb";
        stream(toolpath, latticeOf(0.1), {}, {}, path);
        files[n] = InputFile(path).bytes();
    }
    EXPECT_TRUE(files[0] == files[1]);
    EXPECT_TRUE(files[0] == files[2]);
}

TEST_F(VdbStreamTest, LeavesAreFoundByTheListOfTheirSizes) {
    const gcode::Toolpath toolpath = randomLayers(5, 20, 5, 15);
    const fs::path path = folder_ / "print.vdb";
    stream(toolpath, latticeOf(0.1), {}, {}, path);
    const auto at_once = openvdb::gridPtrCast<openvdb::FloatGrid>(test::readAll(path, false)->front());
    const auto delayed = openvdb::gridPtrCast<openvdb::FloatGrid>(test::readAll(path, true)->front());
    EXPECT_GT(at_once->tree().leafCount(), 1000U);
    auto other = delayed->tree().cbeginLeaf();
    for (auto leaf = at_once->tree().cbeginLeaf(); leaf; ++leaf, ++other)
        for (openvdb::Index n = 0; n < 512; ++n) ASSERT_EQ(leaf->getValue(n), other->getValue(n));
}

TEST_F(VdbStreamTest, AFullDiskLeavesTheOldFile) {
    const fs::path missing = folder_ / "no" / "print.vdb";
    const gcode::Toolpath toolpath = randomLayers(6, 10, 2, 5);
    EXPECT_THROW(stream(toolpath, latticeOf(0.1), {}, {}, missing), OutputError);
    PositionedFile full("/dev/full", "print.vdb");
    EXPECT_THROW(full.write(0, "text"), OutputError);
    char text[] = "text";
    iovec part{text, sizeof text};
    EXPECT_THROW(full.write(0, std::span(&part, 1)), OutputError);
}

// Masks of a wall, which repeat, take a fraction; random ones no more than they are.
TEST(PackedMasks, AreThoseThatWerePacked) {
    std::mt19937_64 random(8);
    for (const std::size_t count : {0U, 1U, 7U, 4096U})
        for (const bool wall : {true, false}) {
            SCOPED_TRACE(count);
            std::vector<LeafMask> masks(count);
            for (LeafMask& mask : masks)
                for (openvdb::Index32 word = 0; word < LeafMask::WORD_COUNT; ++word)
                    mask.getWord<std::uint64_t>(word) = wall ? std::uint64_t{0x3c} << (8 * word) : random();
            const PackedMasks packed(masks);
            EXPECT_EQ(packed.size(), count);
            EXPECT_LE(packed.bytes(), wall && count == 4096 ? count * 8 : count * sizeof(LeafMask) + 32);
            std::ostringstream expected;
            for (const LeafMask& mask : masks) mask.save(expected);
            std::ostringstream found;
            packed.write(found);
            EXPECT_EQ(found.str(), expected.str());
        }
}

// Leaves whose first and last voxels have random signs, in few nodes and far from each other.
TEST(LevelSetNodes, TilesHaveTheSignsOfOpenVdbsFloodFill) {
    openvdb::initialize();
    using Leaf = openvdb::FloatTree::LeafNodeType;
    for (unsigned seed = 0; seed < 20; ++seed) {
        std::mt19937 random(seed);
        std::uniform_int_distribution<int> place(0, seed % 2 == 0 ? 40 : 1500);
        openvdb::FloatGrid::Ptr grid = openvdb::FloatGrid::create(3.0F);
        for (int n = 0; n < 60; ++n) {
            auto at = [&] { return 8 * (place(random) - 20); };
            auto* leaf = grid->tree().touchLeaf({at() / 4, at() / 4, 8 * at()});
            leaf->setValueOn(random() % 512, 0.5F);
            leaf->setValueOff(0, random() % 2 == 0 ? 3.0F : -3.0F);
            leaf->setValueOff(511, random() % 2 == 0 ? 3.0F : -3.0F);
        }
        openvdb::tools::signedFloodFill(grid->tree(), true, 1, 1);
        LevelSetNodes nodes;
        std::vector<const Leaf*> leaves;
        for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) leaves.push_back(leaf.getLeaf());
        for (std::size_t n = 0; n < leaves.size();) {
            LowerNode node;
            node.origin = leaves[n]->origin() & ~127;
            std::vector<EndSigns> signs;
            std::vector<LeafMask> masks;
            for (; n < leaves.size() && (leaves[n]->origin() & ~127) == node.origin; ++n) {
                const openvdb::Coord local = leaves[n]->origin() - node.origin;
                node.children.setOn(
                    static_cast<openvdb::Index>((local[0] / 8 * 16 + local[1] / 8) * 16 + local[2] / 8));
                masks.push_back(leaves[n]->valueMask());
                signs.push_back({leaves[n]->getFirstValue() < 0, leaves[n]->getLastValue() < 0});
            }
            node.leaves = PackedMasks(masks);
            node.flood(signs);
            nodes.add(std::move(node));
        }
        nodes.flood();
        for (const Compression compression : {Compression::blosc, Compression::none}) {
            const LeafFormat format{compressionFlags(compression), false};
            std::vector<char> ours;
            std::vector<char> theirs;
            PackingStream our_stream(format, nullptr, ours);
            nodes.write(our_stream, 3.0F, false);
            PackingStream their_stream(format, nullptr, theirs);
            grid->tree().writeTopology(their_stream, false);
            EXPECT_TRUE(ours == theirs) << "seed " << seed;
            EXPECT_EQ(ours.size(), nodes.writtenBytes(format, 3.0F));
            EXPECT_LE(ours.size(), LevelSetNodes::mostBytes(format, leaves.size(), 60, 60));
        }
        EXPECT_EQ(nodes.leafCount(), leaves.size());
    }
}

}  // namespace
}  // namespace stratum::exporter
