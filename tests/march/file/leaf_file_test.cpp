#include "march/file/leaf_file.h"

#include "base/error.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "random_rays.h"
#include "rubble.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <limits>
#include <utility>

namespace stratum::march {
namespace {

namespace fs = std::filesystem;

class LeafFileTest : public testing::Test {
protected:
    static void SetUpTestSuite() { openvdb::initialize(); }

    test::ScratchFolder folder_;

    fs::path write(const openvdb::GridCPtrVec& grids, std::uint32_t compression) const {
        const fs::path path = folder_ / "grids.vdb";
        openvdb::io::File file(path.string());
        file.setCompression(compression);
        file.write(grids);
        return path;
    }

    // Spheres of many leaves, with an active tile and inside tiles at all levels.
    static openvdb::FloatGrid::Ptr withTiles() {
        auto grid = test::rubble(0.05F, true);
        grid->tree().addTile(1, openvdb::Coord(800, 0, 0), -0.1F, false);
        grid->tree().addTile(1, openvdb::Coord(-800, 8, 16), 0.05F, true);
        grid->tree().addTile(2, openvdb::Coord(0, 1024, 0), -0.15F, false);
        grid->tree().addTile(3, openvdb::Coord(8192, 0, 0), -0.02F, false);
        return grid;
    }
};

constexpr std::uint32_t kMask = openvdb::io::COMPRESS_ACTIVE_MASK;
constexpr std::uint32_t kBlosc = openvdb::io::COMPRESS_BLOSC;
constexpr std::uint32_t kZip = openvdb::io::COMPRESS_ZIP;

TEST(TileValues, AreThoseGivenInLittleMemory) {
    for (const std::size_t different : {1U, 2U, 3U, 200U}) {
        std::vector<float> values(4096);
        for (std::size_t n = 0; n < values.size(); ++n) values[n] = 0.5F * static_cast<float>(n * n % different) - 1;
        const TileValues tiles(values);
        for (std::size_t n = 0; n < values.size(); ++n) ASSERT_EQ(tiles[n], values[n]) << different << " " << n;
        if (different == 1) {
            EXPECT_LT(tiles.bytes(), 100U);
        }
        if (different == 2) {
            EXPECT_LT(tiles.bytes(), 700U);
        }
    }
}

TEST_F(LeafFileTest, HasWhatOpenVdbReads) {
    const auto first = withTiles();
    first->setName("other");
    auto grid = withTiles();
    // A leaf whose inactive samples are of many values, and one that has none.
    for (int n = 0; n < 300; ++n) grid->tree().setValueOff(openvdb::Coord(n % 8, n / 8 % 8, n / 64), 0.001F * n);
    for (int n = 0; n < 512; ++n) grid->tree().setValueOn(openvdb::Coord(16 + n % 8, n / 8 % 8, n / 64), -0.0002F * n);
    for (const std::uint32_t compression : {kMask | kBlosc, kBlosc, kMask, std::uint32_t{0}}) {
        const fs::path path = write({first, grid}, compression);
        const auto file = openLevelSet(path);
        ASSERT_NE(file, nullptr) << compression;
        const auto read = readLevelSet(path);
        EXPECT_EQ(file->name(), "surface");
        EXPECT_EQ(file->background(), read->background());
        EXPECT_EQ(file->leafCount(), read->tree().leafCount());
        EXPECT_EQ(file->activeVoxelCount(), read->activeVoxelCount());
        EXPECT_EQ(file->activeBox(), read->evalActiveVoxelBoundingBox());
        EXPECT_EQ(file->head().transform(), read->transform());
        EXPECT_EQ(file->head().getGridClass(), openvdb::GRID_LEVEL_SET);
        std::vector<float> scratch(LeafSource::kLeafSamples);
        for (std::size_t n = 0; n < file->leafCount(); ++n) {
            const auto* leaf = read->tree().probeConstLeaf(file->origin(n));
            ASSERT_NE(leaf, nullptr) << n;
            const float* samples = file->samples(n, scratch.data());
            for (openvdb::Index k = 0; k < LeafSource::kLeafSamples; ++k)
                ASSERT_EQ(std::bit_cast<std::uint32_t>(samples[k]), std::bit_cast<std::uint32_t>(leaf->getValue(k)));
        }
        int tiles = 0;
        for (int x = -2048; x < 16384; x += 72)
            for (int y = -2048; y < 2048; y += 56)
                for (const int z : {-4000, -64, 0, 16, 500}) {
                    const openvdb::Coord at(x, y, z);
                    if (read->tree().probeConstLeaf(at) != nullptr) continue;
                    ASSERT_EQ(file->tile(at), read->tree().getValue(at)) << at;
                    tiles += file->tile(at) != file->background() ? 1 : 0;
                }
        EXPECT_GT(tiles, 10);
        for (const openvdb::Coord at : {openvdb::Coord(803, 1, 2), openvdb::Coord(-797, 9, 17),
                                        openvdb::Coord(5, 1100, 7), openvdb::Coord(9000, 100, 100)})
            EXPECT_EQ(file->tile(at), read->tree().getValue(at));
    }
}

// Large enough to be laid out as rays come: the hits are those of a grid that was read whole.
TEST_F(LeafFileTest, LazyBricksHaveTheSameHits) {
    const auto grid = test::rubble(0.02F, false);
    const auto file = openLevelSet(write({grid}, kMask | kBlosc));
    ASSERT_NE(file, nullptr);
    EXPECT_GT(file->leafCount(), 10000U);
    for (const BrickValues values : {BrickValues::Float32, BrickValues::Int16}) {
        const auto whole = makeBrickIntersector(*grid, values);
        const auto lazy = makeBrickIntersector(file, values);
        EXPECT_LT(lazy->bytes(), whole->bytes() / 2);
        const std::vector<trace::Ray> rays = test::randomRays(50000, 4, 0.02, 31);
        std::vector<trace::Hit> expected(rays.size());
        std::vector<trace::Hit> hits(rays.size());
        whole->makeTracer()->intersectStream(rays, expected);
        lazy->makeTracer()->intersectStream(rays, hits);
        std::vector<std::uint8_t> blocked(rays.size());
        makeBrickIntersector(file, values)->makeTracer()->occludedStream(rays, blocked);
        std::size_t met = 0;
        for (std::size_t n = 0; n < rays.size(); ++n) {
            ASSERT_EQ(std::isfinite(hits[n].t), std::isfinite(expected[n].t)) << n;
            ASSERT_EQ(blocked[n] != 0, std::isfinite(expected[n].t)) << n;
            if (!std::isfinite(hits[n].t)) continue;
            ++met;
            ASSERT_EQ(hits[n].t, expected[n].t);
            ASSERT_EQ(hits[n].normal, expected[n].normal);
        }
        EXPECT_GT(met, 15000U);
    }
}

TEST_F(LeafFileTest, HalvesAndZip) {
    const auto grid = test::rubble(0.1F, true);
    const auto half = grid->deepCopy();
    half->setSaveFloatAsHalf(true);
    // OpenVDB never zips level sets, but it may find them zipped.
    const auto unclassed = grid->deepCopy();
    unclassed->setGridClass(openvdb::GRID_UNKNOWN);
    for (const auto& [written, compression] :
         {std::pair{half, kMask | kBlosc}, std::pair{half, kMask}, std::pair{unclassed, kMask | kZip}}) {
        const fs::path path = write({written}, compression);
        const auto file = LeafFile::open(InputFile(path), "surface", *grid);
        ASSERT_NE(file, nullptr);
        openvdb::io::File whole(path.string());
        whole.open(/*delayLoad=*/false);
        const auto read = openvdb::gridPtrCast<openvdb::FloatGrid>(whole.readGrid("surface"));
        ASSERT_EQ(file->leafCount(), read->tree().leafCount());
        std::vector<float> scratch(LeafSource::kLeafSamples);
        for (std::size_t n = 0; n < file->leafCount(); ++n) {
            const auto* leaf = read->tree().probeConstLeaf(file->origin(n));
            ASSERT_NE(leaf, nullptr) << n;
            const float* samples = file->samples(n, scratch.data());
            ASSERT_TRUE(std::equal(samples, samples + LeafSource::kLeafSamples, leaf->buffer().data()));
        }
    }
}

TEST_F(LeafFileTest, LeavesInstancesToOpenVdb) {
    const auto grid = test::rubble(0.1F, false);
    const auto twin = grid->copy();
    twin->setName("twin");
    const fs::path path = write({grid, twin}, kMask | kBlosc);
    EXPECT_NE(openLevelSet(path), nullptr);
    EXPECT_EQ(openLevelSet(path, "twin"), nullptr);
    EXPECT_EQ(readLevelSet(path, "twin")->tree().leafCount(), grid->tree().leafCount());
}

TEST_F(LeafFileTest, RefusesDamage) {
    const fs::path path = write({test::rubble(0.1F, false)}, kMask | kBlosc);
    const auto size = fs::file_size(path);
    for (const double share : {0.0, 0.01, 0.1, 0.5, 0.9, 0.999}) {
        const fs::path cut = folder_ / "cut.vdb";
        fs::copy_file(path, cut, fs::copy_options::overwrite_existing);
        fs::resize_file(cut, static_cast<std::uintmax_t>(share * static_cast<double>(size)));
        EXPECT_THROW(openLevelSet(cut), InputError) << share;
    }
}

// Bytes changed anywhere: refused, read as something else, but nothing worse.
TEST_F(LeafFileTest, SurvivesChangedBytes) {
    const fs::path path = write({test::rubble(0.1F, false)}, kMask | kBlosc);
    const std::string good = test::bytesOf(path);
    std::mt19937 random(9);
    int refused = 0;
    for (int n = 0; n < 400; ++n) {
        std::string bad = good;
        // Half of them in the head and the tree.
        const std::size_t reach = n % 2 == 0 ? bad.size() : std::min<std::size_t>(bad.size(), 60000);
        for (int k = 0; k < 4; ++k) bad[random() % reach] = static_cast<char>(random());
        const fs::path changed = folder_ / "changed.vdb";
        std::ofstream(changed, std::ios::binary).write(bad.data(), static_cast<std::streamsize>(bad.size()));
        try {
            const auto file = openLevelSet(changed);
            if (!file) continue;
            std::vector<float> scratch(LeafSource::kLeafSamples);
            for (std::size_t leaf = 0; leaf < file->leafCount(); ++leaf) (void)file->samples(leaf, scratch.data());
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 50);
}

}  // namespace
}  // namespace stratum::march
