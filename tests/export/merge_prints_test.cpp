#include "export/parts/merge_prints.h"

#include "base/error.h"
#include "base/input_file.h"
#include "export/parts/checksum.h"
#include "export/parts/part_file.h"
#include "export/vdb_archive.h"
#include "export/vdb_stream.h"
#include "scratch_folder.h"
#include "toolpaths.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::exporter {
namespace {

namespace fs = std::filesystem;

class MergePrintsTest : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    // Lines in layers of 0.2 mm at random places of a square; `high`: some stand in other upper nodes.
    static gcode::Toolpath print(double from, double size, bool high) {
        std::mt19937 random(7);
        std::uniform_real_distribution<double> place(from, from + size);
        gcode::Toolpath toolpath;
        for (int layer = 1; layer <= 6; ++layer)
            for (int n = 0; n < 12; ++n) {
                const double z = 0.2 * layer + (high && n > 8 ? 410 : 0);
                test::addBead(toolpath, place(random), place(random), z, place(random), place(random), z, 0.45, 0.2);
            }
        return toolpath;
    }

    // One process's file, or the part of a shard.
    fs::path write(const std::string& name, const gcode::Toolpath& toolpath, const std::optional<Shard>& shard,
                   const FileOptions& options = {}, const std::string& scene = "scene",
                   const std::string& version = "1") {
        const std::vector<std::uint32_t> beads = test::allBeads(toolpath);
        voxelize::Lattice lattice;
        lattice.voxel_size = 0.1;
        lattice.layer_height = 0.2;
        voxelize::VoxelizeOptions voxelize_options;
        voxelize_options.in_memory = false;
        voxelize_options.shard = shard;
        voxelize::Voxelizer voxelizer(toolpath, beads, lattice, voxelize_options);
        const auto grid = voxelizer.emptyGrid();
        describe(*grid, lattice, {});
        const voxelize::LeafBounds bounds = voxelizer.leafBounds();
        std::optional<PartOfPrint> part;
        if (shard) part = PartOfPrint{*shard, version, scene, voxelizer.blocks(), bounds.print, {}, 0};
        const fs::path path = shard ? shardName(folder_ / name, *shard) : folder_ / name;
        VdbStream file(grid, path, options, bounds, part);
        voxelizer.stream(0xffffffff, bounds, file, false);
        const WrittenGrid written = file.finish();
        EXPECT_LE(written.leaves, bounds.leaves);
        return path;
    }

    std::vector<fs::path> parts(const gcode::Toolpath& toolpath, int count, const FileOptions& options = {}) {
        std::vector<fs::path> paths;
        for (int n = 0; n < count; ++n) paths.push_back(write("part.vdb", toolpath, Shard{n, count}, options));
        return paths;
    }

    static std::string bytesOf(const fs::path& path) { return std::string(InputFile(path).bytes()); }

    fs::path damaged(const fs::path& part, const std::string& name, std::size_t at) {
        std::string bytes = bytesOf(part);
        bytes.at(at) = static_cast<char>(bytes.at(at) ^ 1);
        return save(name, bytes);
    }
    fs::path save(const std::string& name, const std::string& bytes) {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return folder_ / name;
    }

    // What mergePrint() says of parts that it refuses.
    std::string refusal(const std::vector<fs::path>& paths) {
        const fs::path output = folder_ / "refused.vdb";
        try {
            mergePrint(output, paths);
        } catch (const InputError& error) {
            EXPECT_FALSE(fs::exists(output));
            return error.what();
        }
        ADD_FAILURE() << "was merged";
        return {};
    }
    void expectRefused(const std::vector<fs::path>& paths, const std::vector<std::string>& fragments) {
        const std::string said = refusal(paths);
        for (const std::string& fragment : fragments)
            EXPECT_NE(said.find(fragment), std::string::npos) << fragment << " is not in: " << said;
    }

    test::ScratchFolder folder_;
};

TEST_F(MergePrintsTest, HasTheBytesOfOneProcess) {
    const gcode::Toolpath flat = print(-30, 60, false);
    const gcode::Toolpath towers = print(-10, 20, true);
    const gcode::Toolpath tiny = print(3, 1, false);  // one block
    int number = 0;
    for (const gcode::Toolpath* toolpath : {&flat, &towers, &tiny}) {
        const fs::path whole = write("whole.vdb", *toolpath, {});
        for (const int count : {1, 2, 7, 64}) {
            std::vector<fs::path> paths = parts(*toolpath, count);
            std::reverse(paths.begin(), paths.end());
            const fs::path merged = folder_ / "merged.vdb";
            EXPECT_EQ(mergePrint(merged, paths).parts, count);
            EXPECT_TRUE(bytesOf(merged) == bytesOf(whole)) << count << " shards of print " << number;
        }
        ++number;
    }
}

TEST_F(MergePrintsTest, OfEveryCompression) {
    const gcode::Toolpath toolpath = print(-10, 20, false);
    for (const Compression compression : {Compression::blosc, Compression::zip, Compression::none})
        for (const bool half : {false, true}) {
            const FileOptions options{half, compression};
            const fs::path whole = write("whole.vdb", toolpath, {}, options);
            const fs::path merged = folder_ / "merged.vdb";
            mergePrint(merged, parts(toolpath, 3, options));
            EXPECT_TRUE(bytesOf(merged) == bytesOf(whole)) << static_cast<int>(compression) << half;
        }
}

// A part whose list of leaves has lost some: the checksum of its head is that of the new bytes.
TEST_F(MergePrintsTest, RefusesAListOfOtherLeaves) {
    const gcode::Toolpath toolpath = print(-10, 20, false);
    const fs::path part = parts(toolpath, 1).front();
    const GridPlaces places = readPartFile(part).places;
    std::string bytes = bytesOf(part);
    const std::string name = "file_delayed_load";
    const std::size_t value = bytes.find(name) + name.size() + 4 + std::string("__delayedload").size() + 4;
    // How many, a length that means plain, a byte a leaf, the same length again, eight bytes a leaf.
    std::uint32_t leaves = 0;
    std::memcpy(&leaves, bytes.data() + value, sizeof leaves);
    ASSERT_GT(leaves, 3U);
    const std::string kinds = bytes.substr(value + 8, leaves);
    const std::string sizes = bytes.substr(value + 8 + leaves + 4, std::size_t{8} * leaves);
    const std::uint32_t fewer = leaves - 3;
    std::string list(reinterpret_cast<const char*>(&fewer), sizeof fewer);
    list +=
        std::string(4, '\0') + kinds.substr(0, fewer) + std::string(4, '\0') + sizes.substr(0, std::size_t{8} * fewer);
    bytes.replace(value, list.size(), list);
    const std::string_view head = std::string_view(bytes).substr(places.head, places.leaves - places.head);
    const std::string header = VdbArchive(0).header(1, identityOfPart(head));
    bytes.replace(0, header.size(), header);
    expectRefused({save("list.vdb", bytes)}, {"is damaged", "other leaves"});
}

TEST_F(MergePrintsTest, PartsAreLevelSetsThatOpenVdbReads) {
    const gcode::Toolpath toolpath = print(-30, 60, false);
    std::size_t voxels = 0;
    for (const fs::path& path : parts(toolpath, 64)) {
        openvdb::io::File file(path.string());
        file.open(false);
        const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
        EXPECT_EQ(grid->metaValue<std::int32_t>("shard_count"), 64);
        voxels += grid->activeVoxelCount();
    }
    openvdb::io::File file(write("whole.vdb", toolpath, {}).string());
    file.open(false);
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
    EXPECT_EQ(grid->activeVoxelCount(), voxels);
}

TEST_F(MergePrintsTest, NamesEveryBadPart) {
    const gcode::Toolpath toolpath = print(-10, 20, false);
    const std::vector<fs::path> good = parts(toolpath, 3);
    expectRefused({good[0], good[2]}, {"shard 1 of 3 is missing; make it with --shard 1/3", "nothing is written"});
    expectRefused({good[1]}, {"shard 0 of 3 is missing", "shard 2 of 3 is missing"});
    expectRefused({good[0], good[1], good[2], good[0]}, {"part.0of3.vdb: is shard 0 of 3", "name each once"});
    const fs::path of_two = write("part.vdb", toolpath, Shard{1, 2});
    expectRefused({good[0], good[1], good[2], of_two}, {"part.1of2.vdb: is one of 2 shards, not of 3"});
    const fs::path other = write("other.vdb", toolpath, Shard{1, 3}, {}, "another");
    expectRefused({good[0], other, good[2]}, {"other.1of3.vdb: is of another scene", "shard 1 of 3 is missing"});
    const fs::path newer = write("newer.vdb", toolpath, Shard{1, 3}, {}, "scene", "2");
    expectRefused({good[0], newer, good[2]}, {"newer.1of3.vdb: is made by version 2, not 1"});
    const fs::path packed =
        write("packed.vdb", toolpath, Shard{1, 3}, {.half = false, .compression = Compression::zip});
    expectRefused({good[0], packed, good[2]}, {"packed.1of3.vdb: is of another print of the same scene"});
    const fs::path whole = write("whole.vdb", toolpath, {});
    expectRefused({good[0], whole, good[2]}, {"whole.vdb: is no part of a print"});
    expectRefused({good[0], save("text.vdb", "G1 X1"), good[2]}, {"text.vdb: is no part of a print"});
    expectRefused({good[0], folder_ / "gone.vdb", good[2]}, {"gone.vdb"});
}

TEST_F(MergePrintsTest, DamageAnywhereIsFound) {
    const gcode::Toolpath toolpath = print(-10, 20, false);
    const std::vector<fs::path> good = parts(toolpath, 2);
    const std::string bytes = bytesOf(good[1]);
    const PartFile part = readPartFile(good[1]);
    EXPECT_TRUE(isPartOfPrint(good[1], "1", "scene", {1, 2}));
    for (const Shard& shard : {Shard{0, 2}, Shard{1, 3}}) EXPECT_FALSE(isPartOfPrint(good[1], "1", "scene", shard));
    EXPECT_FALSE(isPartOfPrint(good[1], "2", "scene", {1, 2}));
    EXPECT_FALSE(isPartOfPrint(good[1], "1", "another", {1, 2}));
    EXPECT_FALSE(isPartOfPrint(folder_ / "gone.vdb", "1", "scene", {1, 2}));
    std::mt19937 random(1);
    std::vector<std::size_t> places{
        8, 21, 30, part.places.head, part.places.topology, part.places.leaves, bytes.size() - 1};
    for (int n = 0; n < 100; ++n) places.push_back(8 + random() % (bytes.size() - 8));
    for (const std::size_t at : places) {
        const fs::path bad = damaged(good[1], "bad.vdb", at);
        EXPECT_FALSE(isPartOfPrint(bad, "1", "scene", {1, 2})) << at;
        expectRefused({good[0], bad}, {"bad.vdb: is "});
    }
    for (const std::size_t length : {std::size_t{50}, part.places.head + 30, part.places.topology, part.places.leaves,
                                     bytes.size() / 2, bytes.size() - 1})
        expectRefused({good[0], save("cut.vdb", bytes.substr(0, length))}, {"cut.vdb: is "});
    expectRefused({good[0], save("long.vdb", bytes + "x")}, {"long.vdb: is damaged"});
}

}  // namespace
}  // namespace stratum::exporter
