#include "export/vdb_file.h"

#include "base/error.h"
#include "scratch_folder.h"
#include "toolpaths.h"
#include "vdb_bytes.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

namespace stratum::exporter {
namespace {

openvdb::FloatGrid::Ptr oneBead(voxelize::Lattice& lattice) {
    static gcode::Toolpath toolpath;
    if (toolpath.empty()) test::addBead(toolpath, 0, 0, 0.2, 5, 0, 0.2, 0.5, 0.2);
    lattice.voxel_size = 0.05;
    lattice.layer_height = 0.2;
    return voxelize::voxelize(toolpath, test::allBeads(toolpath), lattice);
}

openvdb::FloatGrid::Ptr readBack(const std::filesystem::path& path) {
    openvdb::io::File file(path.string());
    file.open(false);
    return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
}

class VdbFile : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }
    test::ScratchFolder folder_;
    std::filesystem::path path_ = folder_ / "print.vdb";
};

TEST_F(VdbFile, KeepsEveryValueWithEveryCompression) {
    voxelize::Lattice lattice;
    const auto grid = oneBead(lattice);
    describe(*grid, lattice, {});
    for (const Compression compression : {Compression::blosc, Compression::zip, Compression::none}) {
        writeVdb({grid}, path_, {false, compression});
        const auto back = readBack(path_);
        ASSERT_EQ(back->activeVoxelCount(), grid->activeVoxelCount());
        const auto accessor = back->getConstAccessor();
        for (auto it = grid->cbeginValueAll(); it; ++it) ASSERT_EQ(accessor.getValue(it.getCoord()), *it);
    }
}

TEST_F(VdbFile, TreesHaveTheBytesOfOpenVdbsWriter) {
    gcode::Toolpath toolpath;
    for (int n = 0; n < 30; ++n)
        test::addBead(toolpath, 0, n, 0.2 + 0.2 * (n % 3), 20, n - 3.0, 0.2 + 0.2 * (n % 3), 0.5, 0.2);
    voxelize::Lattice lattice;
    lattice.voxel_size = 0.08;
    lattice.layer_height = 0.2;
    const std::vector<std::uint32_t> beads = test::allBeads(toolpath);
    voxelize::Voxelizer voxelizer(toolpath, beads, lattice);
    const auto grid = voxelizer.printAll();
    describe(*grid, lattice, {});
    openvdb::GridPtrVec grids{grid};
    // Integers, floats and vectors; their inactive voxels have a value of their own.
    const std::vector<voxelize::Attribute> wanted{voxelize::Attribute::layer, voxelize::Attribute::width,
                                                  voxelize::Attribute::color};
    for (const auto& attribute : voxelizer.attributes(wanted)) grids.push_back(attribute);
    auto odd = openvdb::FloatGrid::create(1);
    odd->setName("odd");
    for (int n = 0; n < 512; ++n) odd->tree().setValueOff({n / 64, n / 8 % 8, n % 8}, static_cast<float>(n % 5));
    for (int n = 0; n < 40; ++n) odd->tree().setValueOn({n, 3 * n, 5 * n}, static_cast<float>(n));
    odd->tree().addTile(2, {5000, 0, 0}, 7, true);
    grids.push_back(odd);
    grids.push_back(openvdb::FloatGrid::create(2));  // without a leaf
    grids.back()->setName("empty");
    for (const Compression compression : {Compression::blosc, Compression::zip, Compression::none})
        for (const bool half : {false, true}) {
            writeVdb(grids, path_, {half, compression});
            test::OpenVdbArchive::writeFile(grids, folder_ / "theirs.vdb", compressionFlags(compression));
            test::expectSameContents(path_, folder_ / "theirs.vdb");
        }
}

TEST_F(VdbFile, SaysWhereItCameFrom) {
    voxelize::Lattice lattice;
    const auto grid = oneBead(lattice);
    Provenance provenance;
    provenance.source_file = "tile.gcode";
    provenance.source_sha256 = "00ff";
    provenance.slicer = "PrusaSlicer 2.5.0";
    describe(*grid, lattice, provenance);
    writeVdb({grid}, path_);
    const auto back = readBack(path_);
    EXPECT_EQ(back->metaValue<std::string>("source_file"), "tile.gcode");
    EXPECT_EQ(back->metaValue<std::string>("source_sha256"), "00ff");
    EXPECT_EQ(back->metaValue<std::string>("slicer"), "PrusaSlicer 2.5.0");
    EXPECT_EQ(back->metaValue<std::string>("unit"), "mm");
    EXPECT_EQ(back->metaValue<std::string>("up"), "z");
    EXPECT_EQ(back->metaValue<std::string>("program"), "gcode2vdb " STRATUM_VERSION);
    EXPECT_DOUBLE_EQ(back->metaValue<double>("voxel_size_mm"), 0.05);
    EXPECT_EQ(back->metaValue<openvdb::Int64>("file_voxel_count"),
              static_cast<openvdb::Int64>(grid->activeVoxelCount()));
    EXPECT_EQ(back->getGridClass(), openvdb::GRID_LEVEL_SET);
    // A series describes one grid for each of its files.
    provenance.snapshot = "layer0009";
    describe(*grid, lattice, provenance);
    EXPECT_EQ(grid->metaValue<std::string>("snapshot"), "layer0009");
    provenance.snapshot.clear();
    describe(*grid, lattice, provenance);
    EXPECT_EQ((*grid)["snapshot"], nullptr);
}

TEST_F(VdbFile, HalfPrecisionIsGoodToAThousandthOfTheBand) {
    voxelize::Lattice lattice;
    const auto grid = oneBead(lattice);
    writeVdb({grid}, path_, {true, Compression::blosc});
    const auto back = readBack(path_);
    const auto accessor = back->getConstAccessor();
    for (auto it = grid->cbeginValueOn(); it; ++it)
        ASSERT_NEAR(accessor.getValue(it.getCoord()), *it, grid->background() / 1024);
}

TEST_F(VdbFile, AnUnwritablePlaceIsAnErrorThatLeavesNothing) {
    voxelize::Lattice lattice;
    const auto grid = oneBead(lattice);
    EXPECT_THROW(writeVdb({grid}, "/nonexistent/folder/out.vdb"), OutputError);
}

}  // namespace
}  // namespace stratum::exporter
