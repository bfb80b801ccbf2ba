#include "ondemand/print_field.h"

#include "base/input_file.h"
#include "base/parallel_for.h"
#include "corpus.h"
#include "deposit/read_print.h"
#include "gcode/reader.h"
#include "march/brick/brick_grid.h"
#include "march/brick/brick_intersector.h"
#include "march/brick/brick_walk.h"
#include "toolpaths.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <optional>
#include <random>

namespace stratum::ondemand {
namespace {

using ToolpathPtr = std::shared_ptr<const gcode::Toolpath>;

struct Print {
    const char* name;
    const char* path;    // below data/gcode or the corpus's gcode
    const char* layers;  // as for --layers
    bool corpus;
    int per_layer;
    gcode::DepositModel deposit = {};
};

gcode::DepositModel settledWith(double corner_fraction) {
    gcode::DepositModel deposit;
    deposit.beads = gcode::DepositModel::Beads::settled;
    deposit.corner_fraction = corner_fraction;
    deposit.crown = 0.2;
    return deposit;
}
const gcode::DepositModel kSettled = settledWith(1);
// Beads that widen, discs, sloped beads.
const gcode::DepositModel kFlowing = [] {
    gcode::DepositModel deposit = settledWith(1);
    deposit.flow_lag = 0.05;
    deposit.sag = 0.03;
    return deposit;
}();
const gcode::DepositModel kSettledCorners = settledWith(0.4);

class FieldOfPrint : public testing::TestWithParam<Print> {};

INSTANTIATE_TEST_SUITE_P(
    Prints, FieldOfPrint,
    testing::Values(Print{"hull", "hull.gcode", "1:30", false, 4}, Print{"gear", "gear.gcode", "1:", false, 2},
                    Print{"gear_odd", "gear.gcode", "1:", false, 3}, Print{"gear_coarse", "gear.gcode", "1:", false, 1},
                    Print{"gear_settled", "gear.gcode", "1:20", false, 2, kSettled},
                    Print{"bridges_flowing", "bridges.gcode", "1:12", false, 3, kFlowing},
                    // The band is less than what beads reach to fill a groove.
                    Print{"knot_settled", "knot.gcode", "1:9", false, 10, kSettledCorners},
                    Print{"arcs_superslicer", "preprocess_cancellation-superslicer.gcode", "1:20", true, 2},
                    Print{"vase", "vase_ps25.gcode", "1:40", true, 2},
                    Print{"mixed_heights", "gcode-preview-benchy_slic3r.gcode", "1:40", true, 2},
                    Print{"tools", "filaswitch-mc_testmodel1_Cura.gcode", "1:20", true, 2}),
    [](const auto& print) { return std::string(print.param.name); });

// Every leaf in the box of the grid and around it: the same bits as the grid has there.
void expectSameSamples(const PrintField& field, const openvdb::FloatGrid& grid) {
    ASSERT_EQ(field.activeBox(), grid.evalActiveVoxelBoundingBox());
    ASSERT_EQ(field.transform(), grid.transform());
    ASSERT_EQ(field.background(), grid.background());
    openvdb::CoordBBox leaves(field.activeBox().min() & ~7, field.activeBox().max() & ~7);
    leaves.expand(8);
    const auto planes = static_cast<std::size_t>((leaves.max()[0] - leaves.min()[0]) / 8 + 1);
    std::atomic<std::size_t> wrong{0};
    std::atomic<std::size_t> made{0};
    parallelFor(planes, 1, [&](std::size_t first, std::size_t last) {
        const auto accessor = grid.getConstAccessor();
        const auto made_here = std::make_unique<march::FieldSamples>();
        for (std::size_t plane = first; plane != last; ++plane)
            for (int j = leaves.min()[1]; j <= leaves.max()[1]; j += 8)
                for (int k = leaves.min()[2]; k <= leaves.max()[2]; k += 8) {
                    const openvdb::Coord at(leaves.min()[0] + 8 * static_cast<int>(plane), j, k);
                    const bool any = field.samples(at, *made_here);
                    const float* samples = any ? made_here->leaf.data() : nullptr;
                    // The plane above: the first one of the next leaf.
                    for (int x = 0; x < 8; ++x)
                        for (int y = 0; y < 8; ++y) {
                            const float there = accessor.getValue(at.offsetBy(x, y, 8));
                            const float told =
                                any ? made_here->above[static_cast<std::size_t>(8 * x + y)] : field.background();
                            wrong += there == told ? 0 : 1;
                        }
                    const auto* leaf = grid.tree().probeConstLeaf(at);
                    if (leaf == nullptr) {
                        // A tile, of one value.
                        const float tile = accessor.getValue(at);
                        const bool same = samples == nullptr
                                              ? tile == field.background()
                                              : std::all_of(samples, samples + 512, [&](float v) { return v == tile; });
                        wrong += same ? 0 : 1;
                        continue;
                    }
                    ++made;
                    if (samples == nullptr || std::memcmp(samples, leaf->buffer().data(), 512 * sizeof(float)) != 0)
                        ++wrong;
                }
    });
    EXPECT_EQ(wrong.load(), 0U);
    EXPECT_EQ(made.load(), grid.tree().leafCount());
}

// The brick grids of both have the same box, and every surface cell of one is one of the other.
void expectSameBricks(const std::shared_ptr<const PrintField>& field, const openvdb::FloatGrid& grid) {
    const march::BrickGrid eager(grid, march::BrickValues::Int16);
    const march::BrickGrid lazy(field, march::BrickValues::Int16);
    ASSERT_EQ(lazy.origin(), eager.origin());
    ASSERT_EQ(lazy.size(), eager.size());
    EXPECT_EQ(lazy.brickCount(), 0U);
    const auto size = eager.size();
    std::atomic<std::size_t> wrong{0};
    std::atomic<std::size_t> surface_cells{0};
    parallelFor(static_cast<std::size_t>(size[0]), 8, [&](std::size_t first, std::size_t last) {
        for (int x = static_cast<int>(first); x != static_cast<int>(last); ++x)
            for (int y = 0; y < size[1]; ++y)
                for (int z = 0; z < size[2]; ++z) {
                    const march::Block a = findBlock(eager, {x, y, z});
                    const march::Block b = findBlock(lazy, {x, y, z});
                    if (a.surface != b.surface) ++wrong;
                    if (!a.surface || !b.surface) {
                        // Skip what both know to be empty, along z.
                        z = std::max(z, std::min(a.high.z, b.high.z) - 1);
                        continue;
                    }
                    ++surface_cells;
                    if (cornersOf(eager, a.brick, {x, y, z}) != cornersOf(lazy, b.brick, {x, y, z})) ++wrong;
                }
    });
    EXPECT_EQ(wrong.load(), 0U);
    EXPECT_GT(surface_cells.load(), 1000U);
    EXPECT_EQ(lazy.brickCount(), eager.brickCount());
}

void expectSame(const ToolpathPtr& toolpath, const std::vector<std::uint32_t>& selection,
                const voxelize::LatticeRequest& request, const voxelize::Placement& placement = {}) {
    openvdb::initialize();
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), request);
    voxelize::VoxelizeOptions options;
    options.placement = placement;
    const auto grid = voxelize::voxelize(*toolpath, selection, lattice, options);
    const auto field = std::make_shared<const PrintField>(toolpath, selection, lattice, placement, "print");
    expectSameSamples(*field, *grid);
    expectSameBricks(field, *grid);
}

TEST_P(FieldOfPrint, HasTheSamplesOfTheGrid) {
    const Print& print = GetParam();
    const auto path = (print.corpus ? test::corpusDir() / "gcode" : test::dataDir() / "gcode") / print.path;
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "corpus file " << print.path << " is not there";
    const InputFile file(path);
    gcode::ReadOptions options;
    options.deposit = print.deposit;
    const auto toolpath =
        std::make_shared<const gcode::Toolpath>(deposit::readPrint(file.bytes(), print.path, options, false).toolpath);
    voxelize::Selection selection;
    voxelize::parseLayers(print.layers, selection);
    expectSame(toolpath, voxelize::selectBeads(*toolpath, selection), {std::nullopt, print.per_layer});
}

// Beads of all kinds in all directions: level, sloped, round, arcs, single points, far from the origin.
std::shared_ptr<gcode::Toolpath> tangle(unsigned seed) {
    auto toolpath = std::make_shared<gcode::Toolpath>();
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> where(-6, 6);
    const double far = seed % 2 == 0 ? 0 : 900;
    for (int n = 0; n < 60; ++n) {
        const double z = 0.2 * (1 + n % 12);
        if (n % 3 == 0)
            test::addArc(*toolpath, far + where(random), where(random), 1.5, where(random), where(random), z, 0.2, 0.5,
                         0.2);
        else
            test::addBead(*toolpath, far + where(random), where(random), z, far + where(random), where(random),
                          n % 5 == 0 ? z + 0.1 : z, n % 7 == 0 ? 0.15 : 0.5, n % 4 == 0 ? 0.3 : 0.2);
    }
    return toolpath;
}

TEST(PrintField, HasTheSamplesOfTheGridOfBeadsOfAllKinds) {
    for (unsigned seed = 1; seed <= 4; ++seed) {
        SCOPED_TRACE(seed);
        const auto toolpath = tangle(seed);
        expectSame(toolpath, test::allBeads(*toolpath), {0.1, std::nullopt});
        expectSame(toolpath, test::allBeads(*toolpath), {0.073, std::nullopt});
        toolpath->deposit = seed % 2 == 0 ? kSettled : kSettledCorners;
        expectSame(toolpath, test::allBeads(*toolpath), {0.1, std::nullopt});
        expectSame(toolpath, test::allBeads(*toolpath), {0.021, std::nullopt});
    }
}

TEST(PrintField, HasTheSamplesOfTheGridWhereverItIsPlaced) {
    const auto toolpath = tangle(3);
    voxelize::Placement placement;
    placement.unit = 0.1;
    placement.offset[0] = -901.3;
    placement.offset[2] = 5;
    placement.up_y = true;
    expectSame(toolpath, test::allBeads(*toolpath), {0.1, std::nullopt}, placement);
}

// Of a wall, most neighbours of a brick are needed by nobody; grooves that fill have another field.
TEST(PrintField, MakesNoLeavesForSignsThatAreKnown) {
    openvdb::initialize();
    const auto leavesOf = [](const gcode::DepositModel& deposit) {
        const auto toolpath = std::make_shared<gcode::Toolpath>();
        for (int layer = 1; layer <= 40; ++layer)
            test::addBead(*toolpath, 0, 0, 0.2 * layer, 20, 3, 0.2 * layer, 0.5, 0.2);
        toolpath->deposit = deposit;
        const auto beads = test::allBeads(*toolpath);
        const voxelize::Lattice lattice =
            voxelize::chooseLattice(*toolpath, beads, voxelize::boundsOf(*toolpath, beads), {0.1, std::nullopt});
        const auto field = std::make_shared<const PrintField>(toolpath, beads, lattice, voxelize::Placement(), "wall");
        EXPECT_EQ(std::isfinite(field->signSlack()), !deposit.settles());
        const march::BrickGrid bricks(field, march::BrickValues::Int16);
        const auto size = bricks.size();
        for (int x = 0; x < size[0]; ++x)
            for (int y = 0; y < size[1]; ++y)
                for (int z = 0; z < size[2]; ++z) findBlock(bricks, {x, y, z});
        return field->leavesMade();
    };
    EXPECT_LT(leavesOf({}), leavesOf(kSettled));
}

// Backwards, each brick finds its neighbours laid out.
TEST(PrintField, MakesNoLeavesOfWhichNeighboursHaveSamples) {
    openvdb::initialize();
    const InputFile file(test::dataDir() / "gcode" / "gear.gcode");
    const auto toolpath = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), "gear", {}));
    const auto beads = voxelize::selectBeads(*toolpath, {});
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, beads, voxelize::boundsOf(*toolpath, beads), {std::nullopt, 4});
    const auto leavesOf = [&](bool backwards) {
        const auto field = std::make_shared<const PrintField>(toolpath, beads, lattice, voxelize::Placement(), "gear");
        const march::BrickGrid bricks(std::shared_ptr<const march::LeafField>(field), march::BrickValues::Int16);
        const auto size = bricks.size();
        const auto at = [&](int axis, int n) {
            const int cells = size[static_cast<std::size_t>(axis)];
            return backwards ? cells - march::BrickGrid::kBrickEdge - n : n;
        };
        for (int x = 0; x < size[0]; x += march::BrickGrid::kBrickEdge)
            for (int y = 0; y < size[1]; y += march::BrickGrid::kBrickEdge)
                for (int z = 0; z < size[2]; z += march::BrickGrid::kBrickEdge) {
                    const glm::ivec3 cell(at(0, x), at(1, y), at(2, z));
                    const march::MacroCell& macro = bricks.macroCell(cell.x / 32, cell.y / 32, cell.z / 32);
                    const int b[3] = {cell.x / 8 & 3, cell.y / 8 & 3, cell.z / 8 & 3};
                    if ((macro.bricks >> march::Mask64::bit(b[0], b[1], b[2]) & 1) != 0)
                        bricks.ensureBrick(march::BrickGrid::brickIndex(macro, b[0], b[1], b[2]), cell.x / 8,
                                           cell.y / 8, cell.z / 8);
                }
        return field->leavesMade();
    };
    EXPECT_LT(leavesOf(true), leavesOf(false));
}

// A print that grows and shrinks: what is kept and what is made again are the cells of the partial print's grid.
void expectOnlyChanges(const gcode::DepositModel& deposit) {
    openvdb::initialize();
    gcode::ReadOptions options;
    options.deposit = deposit;
    const InputFile file(test::dataDir() / "gcode" / "gear.gcode");
    const auto toolpath = std::make_shared<const gcode::Toolpath>(gcode::readToolpath(file.bytes(), "gear", options));
    const auto selection = voxelize::selectBeads(*toolpath, {});
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {std::nullopt, 2});
    const auto field = std::make_shared<PrintField>(toolpath, selection, lattice, voxelize::Placement(), "print");
    march::BrickGrid lazy(std::shared_ptr<const march::LeafField>(field), march::BrickValues::Int16);
    const auto whole = static_cast<std::uint32_t>(toolpath->beads.size());
    std::size_t changed_before = 0;
    for (const std::uint32_t end : {whole, whole / 2 + 7, whole / 2 + 8, whole / 3, whole}) {
        SCOPED_TRACE(end);
        const auto changed = field->printUntil(end);
        lazy.update(changed);
        if (end == whole / 2 + 8) {
            // One bead.
            EXPECT_GT(changed.size(), 0U);
            EXPECT_LT(changed.size(), changed_before / 20);
        }
        changed_before = changed.size();
        voxelize::Voxelizer voxelizer(*toolpath, selection, lattice);
        const march::BrickGrid eager(*voxelizer.printUntil(end), march::BrickValues::Int16);
        const openvdb::Coord shift = eager.origin() - lazy.origin();
        std::atomic<std::size_t> wrong{0};
        std::atomic<std::size_t> surface_cells{0};
        parallelFor(static_cast<std::size_t>(lazy.size()[0]), 8, [&](std::size_t first, std::size_t last) {
            for (int x = static_cast<int>(first); x != static_cast<int>(last); ++x)
                for (int y = 0; y < lazy.size()[1]; ++y)
                    for (int z = 0; z < lazy.size()[2]; ++z) {
                        const march::Block b = findBlock(lazy, {x, y, z});
                        const glm::ivec3 at(x - shift[0], y - shift[1], z - shift[2]);
                        const bool within = at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < eager.size()[0] &&
                                            at.y < eager.size()[1] && at.z < eager.size()[2];
                        const march::Block a = within ? findBlock(eager, at) : march::Block{b.low, b.high, 0, false};
                        if (a.surface != b.surface) ++wrong;
                        if (!a.surface || !b.surface) {
                            if (!a.surface && !b.surface)
                                z = std::max(z, std::min(within ? a.high.z + shift[2] : b.high.z, b.high.z) - 1);
                            continue;
                        }
                        ++surface_cells;
                        if (cornersOf(eager, a.brick, at) != cornersOf(lazy, b.brick, {x, y, z})) ++wrong;
                    }
        });
        EXPECT_EQ(wrong.load(), 0U);
        EXPECT_GT(surface_cells.load(), 1000U);
        EXPECT_EQ(lazy.brickCount(), eager.brickCount());
    }
}

TEST(PrintField, ChangesOnlyWhatANewMomentChanges) { expectOnlyChanges({}); }
TEST(PrintField, ChangesOnlyWhatANewMomentChangesWhereBeadsSettle) { expectOnlyChanges(kSettled); }

// From around tangle(2) and from inside, in all directions.
std::vector<trace::Ray> raysThrough(std::size_t count) {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<trace::Ray> rays(count);
    for (trace::Ray& ray : rays) {
        ray.origin = {3 * normal(random), 3 * normal(random), 1.2 + normal(random)};
        const glm::dvec3 way(normal(random), normal(random), normal(random));
        ray.direction = way / std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
    }
    return rays;
}

// All threads at the same bricks at once: the grid's hits, bit for bit, and each brick made once.
TEST(PrintField, IsTracedByManyThreadsAsTheGridIs) {
    const auto toolpath = tangle(2);
    const std::vector<std::uint32_t> selection = test::allBeads(*toolpath);
    openvdb::initialize();
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {0.1, std::nullopt});
    const auto grid = voxelize::voxelize(*toolpath, selection, lattice);
    const auto eager = march::makeBrickIntersector(*grid);
    const auto [lazy, bricks] = march::makeTracedBricks(
        std::make_shared<const PrintField>(toolpath, selection, lattice, voxelize::Placement(), "print"));
    ASSERT_EQ(lazy->bounds().min, eager->bounds().min);
    ASSERT_EQ(lazy->bounds().max, eager->bounds().max);
    const std::vector<trace::Ray> rays = raysThrough(2000);
    std::vector<trace::Hit> expected(rays.size());
    eager->makeTracer()->intersectStream(rays, expected);
    std::atomic<std::size_t> wrong{0};
    std::atomic<std::size_t> hits{0};
    parallelFor(8, 1, [&, &shape = *lazy](std::size_t, std::size_t) {
        std::vector<trace::Hit> found(rays.size());
        shape.makeTracer()->intersectStream(rays, found);
        for (std::size_t n = 0; n < rays.size(); ++n) {
            if (found[n].t != expected[n].t) ++wrong;
            if (!std::isfinite(found[n].t)) continue;
            ++hits;
            if (found[n].normal != expected[n].normal) ++wrong;
        }
    });
    EXPECT_EQ(wrong.load(), 0U);
    EXPECT_GT(hits.load(), 1000U);
    EXPECT_LE(bricks->brickCount(), march::BrickGrid(*grid, march::BrickValues::Int16).brickCount());
}

// Bricks come and go under the rays of many threads: the same hits, whatever room there is.
TEST(PrintField, IsTracedInLittleRoomAsTheGridIs) {
    const auto toolpath = tangle(2);
    const std::vector<std::uint32_t> selection = test::allBeads(*toolpath);
    openvdb::initialize();
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {0.1, std::nullopt});
    const auto eager = march::makeBrickIntersector(*voxelize::voxelize(*toolpath, selection, lattice));
    constexpr std::size_t brick = march::BrickGrid::kBrickSamples * sizeof(std::int16_t);
    const std::vector<trace::Ray> rays = raysThrough(600);
    std::vector<trace::Hit> expected(rays.size());
    eager->makeTracer()->intersectStream(rays, expected);
    for (const std::size_t room : {march::BrickSlots::kLeastBound, std::size_t{100}, std::size_t{500}}) {
        SCOPED_TRACE(room);
        const auto [lazy, bricks] = march::makeTracedBricks(
            std::make_shared<const PrintField>(toolpath, selection, lattice, voxelize::Placement(), "print"),
            march::BrickValues::Int16, room * brick);
        std::atomic<std::size_t> wrong{0};
        parallelFor(4, 1, [&, &shape = *lazy](std::size_t first, std::size_t) {
            const auto tracer = shape.makeTracer();
            std::vector<trace::Hit> found(rays.size());
            std::vector<std::uint8_t> blocked(rays.size());
            if (first % 2 == 0) {
                tracer->intersectStream(rays, found);
                tracer->occludedStream(rays, blocked);
            } else {
                tracer->trace::Tracer::intersectStream(rays, found);  // one by one
                tracer->trace::Tracer::occludedStream(rays, blocked);
            }
            for (std::size_t n = 0; n < rays.size(); ++n) {
                if (found[n].t != expected[n].t) ++wrong;
                if ((blocked[n] != 0) != std::isfinite(expected[n].t)) ++wrong;
                if (std::isfinite(found[n].t) && found[n].normal != expected[n].normal) ++wrong;
            }
        });
        EXPECT_EQ(wrong.load(), 0U);
        const march::BrickCacheCounts counts = bricks->cache().counts();
        EXPECT_EQ(counts.slots, room);
        EXPECT_EQ(counts.peak, room);
        EXPECT_GT(counts.evicted, 0U);
        EXPECT_LE(counts.made - counts.evicted, room);
        EXPECT_GT(counts.hits, 0U);
    }
}

TEST(PrintField, ListsFewBricksWithoutSurface) {
    const auto toolpath = tangle(2);
    const std::vector<std::uint32_t> selection = test::allBeads(*toolpath);
    openvdb::initialize();
    const voxelize::Lattice lattice =
        voxelize::chooseLattice(*toolpath, selection, voxelize::boundsOf(*toolpath, selection), {0.05, std::nullopt});
    const auto field = std::make_shared<const PrintField>(toolpath, selection, lattice, voxelize::Placement(), "print");
    const march::BrickGrid lazy(field, march::BrickValues::Int16);
    const march::BrickGrid eager(*voxelize::voxelize(*toolpath, selection, lattice), march::BrickValues::Int16);
    EXPECT_LE(lazy.listedCount(), 2 * eager.brickCount());
    EXPECT_EQ(field->leavesMade(), 0U);
}

}  // namespace
}  // namespace stratum::ondemand
