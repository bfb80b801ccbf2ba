#include "ondemand/detail_levels.h"

#include "base/input_file.h"
#include "corpus.h"
#include "gcode/reader.h"
#include "march/brick/brick_intersector.h"
#include "ondemand/print_field.h"
#include "trace/detail_intersector.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxel_choice.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace stratum::ondemand {
namespace {

using ToolpathPtr = std::shared_ptr<const gcode::Toolpath>;

// One of its voxels is half a pixel or less wherever it answers, or the finest; and no coarser one there is so.
TEST(DetailLevels, AreAsFineAsPixelsNeedEverywhere) {
    constexpr double kLayer = 0.2;
    for (const double per_distance : {1e-4, 3e-4, 1e-3, 1e-2})
        for (const double nearest : {0.0, 0.5, 3.0, 40.0}) {
            const PixelGrowth pixels{per_distance, nearest + 300.0};
            const double smallest = nearest * per_distance;
            const int finest = voxelize::voxelsPerLayerForPixel(kLayer, smallest);
            const auto levels = chooseLevels(kLayer, finest, smallest, pixels);
            ASSERT_EQ(levels.front().voxels_per_layer, finest);
            ASSERT_EQ(levels.front().from, 0.0);
            for (std::size_t n = 0; n < levels.size(); ++n) {
                const double voxel = kLayer / levels[n].voxels_per_layer;
                if (n > 0) {
                    EXPECT_GT(levels[n].from, levels[n - 1].from);
                    EXPECT_LT(levels[n].from, pixels.farthest);
                    EXPECT_LE(3 * levels[n].voxels_per_layer, 2 * levels[n - 1].voxels_per_layer);
                    EXPECT_NEAR(voxel, levels[n].from * per_distance / 2, 1e-12);
                }
                const double to = n + 1 < levels.size() ? levels[n + 1].from : pixels.farthest;
                if (n > 0 && levels[n].voxels_per_layer > voxelize::kFewestForPixels) {
                    EXPECT_LE(to * per_distance / 2, 2 * voxel * (1 + 1e-12));
                }
            }
        }
    EXPECT_EQ(chooseLevels(kLayer, 16, 0.0, {1e-3, 500.0}).size(), 4U);
}

TEST(DetailLevels, AreOneWhereAPixelSpansMuchTheSame) {
    EXPECT_EQ(chooseLevels(0.2, 4, 0.1, {1e-3, 199.0}).size(), 1U);
    EXPECT_EQ(chooseLevels(0.2, 4, 0.1, {1e-3, 201.0}).size(), 2U);
    EXPECT_EQ(chooseLevels(0.2, 2, 0.2, {1e-3, 900.0}).size(), 1U);
    EXPECT_EQ(chooseLevels(0.2, 16, 0.0, {1e-3, 0.0}).size(), 1U);  // a turntable
    EXPECT_EQ(chooseLevels(0.2, 4, 0.0, {}).size(), 1U);            // not by pixels
}

struct Gear {
    ToolpathPtr toolpath;
    std::vector<std::uint32_t> selection;
    voxelize::Bounds bounds;

    Gear() {
        openvdb::initialize();
        const InputFile file(test::dataDir() / "gcode" / "gear.gcode");
        toolpath = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), "gear"));
        selection = voxelize::selectBeads(*toolpath, {});
        bounds = voxelize::boundsOf(*toolpath, selection);
    }
    // Between the skirt and the gear, 5.6 mm before its front.
    static glm::dvec3 eye() { return {100.3, 73.0, 5.0}; }
    voxelize::Lattice lattice(int per_layer) const {
        return voxelize::chooseLattice(*toolpath, selection, bounds, {std::nullopt, per_layer});
    }
    std::shared_ptr<const PrintField> field(const voxelize::Lattice& lattice, double to) const {
        const double distance = to + lattice.background() + 2 * lattice.voxel_size;
        return std::make_shared<const PrintField>(toolpath, beadsWithin(*toolpath, selection, eye(), distance), lattice,
                                                  voxelize::Placement(), "part");
    }
};

const Gear& gear() {
    static const Gear the_gear;
    return the_gear;
}

// Every sample that a ray within the shell reads, and two voxels around it.
TEST(DetailLevels, BeadsNearTheEyeMakeTheSamplesNearTheEye) {
    const Gear& g = gear();
    for (const int per_layer : {2, 3, 4}) {
        const voxelize::Lattice lattice = g.lattice(per_layer);
        const PrintField all(g.toolpath, g.selection, lattice, voxelize::Placement(), "all");
        for (const double to : {9.0, 15.0}) {
            const auto some = g.field(lattice, to);
            ASSERT_LT(some->layout().stack.beads.size(), g.selection.size() / 2);
            ASSERT_GT(some->layout().stack.beads.size(), 0U);
            const auto a = std::make_unique<march::FieldSamples>();
            const auto b = std::make_unique<march::FieldSamples>();
            std::size_t in_band = 0;
            std::size_t wrong = 0;
            openvdb::CoordBBox leaves(all.activeBox().min() & ~7, all.activeBox().max() & ~7);
            for (int i = leaves.min()[0]; i <= leaves.max()[0]; i += 8)
                for (int j = leaves.min()[1]; j <= leaves.max()[1]; j += 8)
                    for (int k = leaves.min()[2]; k <= leaves.max()[2]; k += 8) {
                        const auto place = [&](int n) {
                            const auto p = all.transform().indexToWorld(
                                openvdb::Coord(i + (n >> 6), j + (n >> 3 & 7), k + (n & 7)));
                            return glm::dvec3(p[0], p[1], p[2]);
                        };
                        const double reach = to + 2 * lattice.voxel_size;
                        if (glm::length(place(0) - g.eye()) > reach + 14 * lattice.voxel_size) continue;
                        if (!all.samples({i, j, k}, *a)) a->leaf.fill(all.background());
                        if (!some->samples({i, j, k}, *b)) b->leaf.fill(all.background());
                        for (int n = 0; n < 512; ++n) {
                            if (glm::length(place(n) - g.eye()) > reach) continue;
                            const float expected = a->leaf[static_cast<std::size_t>(n)];
                            const float found = b->leaf[static_cast<std::size_t>(n)];
                            if (std::memcmp(&expected, &found, sizeof(float)) != 0) ++wrong;
                            if (std::abs(expected) < all.background()) ++in_band;
                        }
                    }
            EXPECT_EQ(wrong, 0U) << per_layer << " " << to;
            EXPECT_GT(in_band, 10000U);
        }
    }
}

// What the eye sees of a print with levels, against all of it at the finest: no farther off than the levels' errors,
// and not more so where one level ends than elsewhere.
TEST(DetailLevels, ShowInNoPicture) {
    const Gear& g = gear();
    const std::array<int, 3> per_layer{8, 4, 2};
    const std::array<double, 4> from{0.0, 12.0, 25.0, std::numeric_limits<double>::infinity()};
    std::vector<trace::DetailLevel> levels;
    for (std::size_t n = 0; n < per_layer.size(); ++n)
        levels.push_back({march::makeBrickIntersector(g.field(g.lattice(per_layer[n]), from[n + 1])), from[n]});
    const auto composite = trace::makeDetailIntersector(levels, g.eye());
    const auto fine =
        march::makeBrickIntersector(g.field(g.lattice(per_layer[0]), std::numeric_limits<double>::infinity()));
    std::vector<trace::Ray> rays;
    for (int y = 0; y < 480; ++y)
        for (int x = 0; x < 640; ++x) {
            trace::Ray ray;
            ray.origin = g.eye();
            ray.direction = glm::normalize(glm::dvec3((x - 320) / 320.0, 1.0, (y - 240) / 400.0));
            rays.push_back(ray);
        }
    std::vector<trace::Hit> expected(rays.size());
    std::vector<trace::Hit> found(rays.size());
    fine->makeTracer()->intersectStream(rays, expected);
    composite->makeTracer()->intersectStream(rays, found);
    const double layer = g.lattice(1).voxel_size;
    struct Sum {
        double error = 0;  // in voxels of the level
        std::size_t rays = 0, off = 0;
        double mean() const { return error / static_cast<double>(rays); }
        double share() const { return static_cast<double>(off) / static_cast<double>(rays); }
    };
    Sum ring;
    Sum elsewhere;
    for (std::size_t n = 0; n < rays.size(); ++n) {
        if (!std::isfinite(expected[n].t) && !std::isfinite(found[n].t)) continue;
        const double t = std::min(expected[n].t, found[n].t);
        const double distance = std::min(std::abs(t - from[1]), std::abs(t - from[2]));
        const bool near = distance < 0.6;
        if (!near && t < from[1]) {
            // Of the finest level; its cells are counted from another corner.
            EXPECT_NEAR(found[n].t, expected[n].t, 1e-9);
            continue;
        }
        Sum& sum = near ? ring : elsewhere;
        const double voxel = layer / per_layer[found[n].part];
        // Across the surface: as near as that to what the other one sees, unless one of them goes by an edge.
        const double off =
            std::abs(found[n].t - expected[n].t) *
            std::abs(glm::dot(std::isfinite(found[n].t) ? found[n].normal : expected[n].normal, rays[n].direction)) /
            voxel;
        ++sum.rays;
        if (!(off < 2 * voxelize::kLargestErrorVoxels))
            ++sum.off;
        else
            sum.error += off;
    }
    ASSERT_GT(ring.rays, 500U);
    ASSERT_GT(elsewhere.rays, 5000U);
    EXPECT_LT(elsewhere.share(), 0.05);
    EXPECT_LT(ring.share(), elsewhere.share() + 0.02);
    EXPECT_LT(elsewhere.mean(), 0.2);
    EXPECT_LT(ring.mean(), 1.25 * elsewhere.mean());
    RecordProperty("ring", std::to_string(ring.mean()) + " " + std::to_string(ring.share()));
    RecordProperty("elsewhere", std::to_string(elsewhere.mean()) + " " + std::to_string(elsewhere.share()));
}

}  // namespace
}  // namespace stratum::ondemand
