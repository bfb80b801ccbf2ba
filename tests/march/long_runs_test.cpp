// Millions of rays at a real print: the claims of exactness, watertightness and bounded work, at full length.
#include "march/brick/brick_intersector.h"
#include "march/brick/brick_walk.h"

#include "base/input_file.h"
#include "base/parallel_for.h"
#include "brute_march.h"
#include "corpus.h"
#include "deposit/printer.h"
#include "deposit/read_print.h"
#include "random_rays.h"
#include "rubble.h"
#include "voxelize/beads/selection.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <numeric>

namespace stratum::march {
namespace {

constexpr double kVoxel = 0.1;                        // mm
constexpr std::size_t kBlock = std::size_t{1} << 14;  // rays that are made and traced at a time

/// All of them with STRATUM_LONG=1 in the environment, else a fiftieth.
std::size_t full(std::size_t rays) { return std::getenv("STRATUM_LONG") != nullptr ? rays : rays / 50; }

// Calls work(tracer, random, rays) for `count` rays in all, in parallel; each block has its own seed.
template <typename Work>
void inBlocks(const trace::Intersector& intersector, std::size_t count, const Work& work) {
    parallelFor((count + kBlock - 1) / kBlock, 1, [&](std::size_t first, std::size_t last) {
        const auto tracer = intersector.makeTracer();
        for (std::size_t block = first; block != last; ++block) {
            std::mt19937 random(static_cast<std::uint32_t>(block) + 1);
            work(*tracer, random, std::min(kBlock, count - block * kBlock));
        }
    });
}

openvdb::FloatGrid::Ptr levelSetOf(const gcode::Toolpath& toolpath) {
    std::vector<std::uint32_t> beads(toolpath.beads.size());
    std::iota(beads.begin(), beads.end(), 0U);
    voxelize::LatticeRequest request;
    request.voxel_size = kVoxel;
    return voxelize::voxelize(toolpath, beads,
                              voxelize::chooseLattice(toolpath, beads, voxelize::boundsOf(toolpath, beads), request));
}

class LongRuns : public testing::Test {
protected:
    static void SetUpTestSuite() {
        const InputFile file(test::dataDir() / "gcode" / "hull.gcode");
        grid_ = levelSetOf(gcode::readToolpath(file.bytes(), "hull.gcode"));
        intersector_ = makeBrickIntersector(*grid_);
    }
    static void TearDownTestSuite() {
        intersector_.reset();
        grid_.reset();
    }

    template <typename Work>
    static void inBlocks(std::size_t count, const Work& work) {
        march::inBlocks(*intersector_, count, work);
    }
    static glm::dvec3 center() { return 0.5 * (intersector_->bounds().min + intersector_->bounds().max); }
    static double radius() { return 0.5 * glm::length(intersector_->bounds().max - intersector_->bounds().min); }
    static glm::dvec3 anywhere(std::mt19937& random) {
        const trace::Box box = intersector_->bounds();
        std::uniform_real_distribution<double> unit(0, 1);
        return box.min + glm::dvec3(unit(random), unit(random), unit(random)) * (box.max - box.min);
    }

    static inline openvdb::FloatGrid::Ptr grid_;
    static inline std::unique_ptr<trace::Intersector> intersector_;
};

TEST_F(LongRuns, AMillionRaysMeetWhatTheBruteMarchMeets) {
    const std::size_t kRays = full(1000000);
    const auto held = test::quantized(*grid_);  // the field that bricks hold, of 16-bit samples
    std::atomic<std::size_t> hits{0};
    std::atomic<std::size_t> missed{0};
    std::atomic<std::size_t> extra{0};
    std::atomic<std::size_t> moved{0};
    std::atomic<std::size_t> crossings{0};  // that the brute march's steps jump over
    inBlocks(kRays, [&](trace::Tracer& tracer, std::mt19937& random, std::size_t count) {
        test::BruteMarch brute(*held);
        for (std::size_t n = 0; n < count; ++n) {
            trace::Ray ray;
            const glm::dvec3 target = anywhere(random);
            ray.origin = n % 2 == 0 ? anywhere(random) : center() + 3 * radius() * test::randomDirection(random);
            ray.direction = glm::normalize(target - ray.origin);
            const auto expected = brute(ray);
            trace::Hit hit;
            const bool found = tracer.intersect(ray, hit);
            if (found && (!expected || hit.t < *expected - 1e-4 * kVoxel)) {
                // Two crossings within a 200th of a chord are one too many for the brute march. It is right to complain
                // unless the field at the hit does change sign, looked at closely.
                trace::Ray close = ray;
                close.t_min = hit.t - 1e-3 * kVoxel;
                close.t_max = hit.t + 1e-3 * kVoxel;
                const auto seen = brute(close);
                if (seen && std::abs(*seen - hit.t) <= 1e-4 * kVoxel) {
                    ++crossings;
                    continue;
                }
            }
            hits += found ? 1 : 0;
            missed += !found && expected ? 1 : 0;
            extra += found && !expected ? 1 : 0;
            moved += found && expected && std::abs(hit.t - *expected) > 1e-4 * kVoxel ? 1 : 0;
        }
    });
    std::printf(
        "  %zu hits; %zu missed, %zu extra, %zu off by more than 1e-4 voxel; %zu grazings the oracle stepped over\n",
        hits.load(), missed.load(), extra.load(), moved.load(), crossings.load());
    EXPECT_GT(hits, kRays / 10);
    EXPECT_EQ(missed, 0U);
    EXPECT_EQ(extra, 0U);
    EXPECT_EQ(moved, 0U);
    EXPECT_LE(crossings, kRays / 10000);
}

// Rays from samples inside a solid, which must all meet its surface from the inside.
void expectNoLeak(const openvdb::FloatGrid& grid, const trace::Intersector& intersector, std::size_t count) {
    std::vector<openvdb::Coord> solid;
    for (auto it = grid.cbeginValueOn(); it; ++it)
        // Samples that are zero but for rounding, on flats that lie on voxel planes, are the surface itself.
        if (*it < -1e-5 * kVoxel) solid.push_back(it.getCoord());
    ASSERT_GT(solid.size(), 1000000U);
    std::atomic<std::size_t> leaks{0};
    std::atomic<std::size_t> wrong{0};
    inBlocks(intersector, count, [&](trace::Tracer& tracer, std::mt19937& random, std::size_t size) {
        std::vector<trace::Ray> rays(size);
        std::vector<trace::Hit> hits(size);
        std::vector<std::uint8_t> blocked(size);
        for (std::size_t n = 0; n < size; ++n) {
            const openvdb::Vec3d start = grid.indexToWorld(solid[random() % solid.size()]);
            rays[n].origin = {start[0], start[1], start[2]};
            rays[n].direction = test::randomDirection(random);
            // Along lattice lines and planes as well.
            if (n % 4 == 0) rays[n].direction[static_cast<glm::length_t>(n / 4 % 3)] = n % 8 == 0 ? 0 : 1e-7;
            if (n % 16 == 0) rays[n].direction[static_cast<glm::length_t>((n / 16 + 1) % 3)] = 0;
            rays[n].direction = glm::normalize(rays[n].direction);
        }
        tracer.intersectStream(rays, hits);
        tracer.occludedStream(rays, blocked);
        for (std::size_t n = 0; n < size; ++n) {
            const bool found = std::isfinite(hits[n].t);
            leaks += found && blocked[n] == 1 ? 0 : 1;
            // From inside, the surface is left through its inner side.
            wrong += found && !(hits[n].t >= 0 && glm::dot(hits[n].normal, rays[n].direction) > -1e-6) ? 1 : 0;
        }
    });
    std::printf("  %zu leaks, %zu met from the wrong side\n", leaks.load(), wrong.load());
    EXPECT_EQ(leaks, 0U);
    EXPECT_EQ(wrong, 0U);
}

TEST_F(LongRuns, TenMillionRaysFromInsideNeverGetOut) { expectNoLeak(*grid_, *intersector_, full(10000000)); }

TEST_F(LongRuns, AMillionRaysFromInsideATypicalPrintNeverGetOut) {
    const InputFile file(test::dataDir() / "gcode" / "gear.gcode");
    gcode::ReadOptions options;
    deposit::usePrinter("typical", options);
    const gcode::Toolpath toolpath = deposit::readPrint(file.bytes(), "gear.gcode", options, false).toolpath;
    const openvdb::FloatGrid::Ptr grid = levelSetOf(toolpath);
    expectNoLeak(*grid, *makeBrickIntersector(*grid), 1000000);
}

TEST_F(LongRuns, TenMillionGrazingRaysEndWithFiniteAnswers) {
    const std::size_t kRays = full(10000000);
    const BrickGrid bricks(*grid_, BrickValues::Float32);
    const CellMap map(*grid_->transform().baseMap(), bricks.origin());
    const std::size_t most_steps = static_cast<std::size_t>(bricks.size()[0] + bricks.size()[1] + bricks.size()[2]);
    std::atomic<std::size_t> hits{0};
    std::atomic<std::size_t> bad{0};
    std::atomic<std::size_t> walked{0};
    std::atomic<std::size_t> longest{0};
    inBlocks(kRays, [&](trace::Tracer& tracer, std::mt19937& random, std::size_t count) {
        std::vector<trace::Ray> rays(count);
        std::vector<trace::Hit> found(count);
        std::uniform_real_distribution<double> unit(-1, 1);
        for (std::size_t n = 0; n < count; ++n) {
            trace::Ray& ray = rays[n];
            // Axis-parallel, tilted by 1e-7 to 1e-1 rad or not at all, with zeros of either sign.
            const auto axis = static_cast<glm::length_t>(n % 3);
            const double tilt = n % 9 == 0 ? 0.0 : std::pow(10.0, -7 + 3 * (1 + unit(random)));
            ray.direction = glm::dvec3(0.0);
            ray.direction[axis] = n % 2 == 0 ? 1 : -1;
            ray.direction[(axis + 1) % 3] = tilt * unit(random);
            ray.direction[(axis + 2) % 3] = n % 5 == 0 ? -0.0 : n % 5 == 1 ? 1e-310 : tilt * unit(random);
            ray.direction = glm::normalize(ray.direction);
            ray.origin = anywhere(random);
            // On grid planes, where layers are flat and touch.
            if (n % 4 != 0) {
                openvdb::Vec3d p = grid_->worldToIndex(openvdb::Vec3d(ray.origin.x, ray.origin.y, ray.origin.z));
                for (int k = 0; k < 3; ++k)
                    if (n % 4 != static_cast<std::size_t>(k) + 1) p[k] = std::round(p[k]);
                p = grid_->indexToWorld(p);
                ray.origin = {p[0], p[1], p[2]};
            }
            if (n % 7 == 0) ray.origin -= 1e6 * ray.direction;
        }
        // A third starts on the surface that another ray met.
        tracer.intersectStream(rays, found);
        for (std::size_t n = 0; n < count; n += 3)
            if (std::isfinite(found[n].t)) rays[n].origin = found[n].position;
        tracer.intersectStream(rays, found);
        std::size_t good_hits = 0;
        for (std::size_t n = 0; n < count; ++n) {
            const trace::Hit& hit = found[n];
            if (std::isinf(hit.t)) continue;
            ++good_hits;
            const double length = glm::length(hit.normal);
            if (!(std::isfinite(hit.t) && hit.t >= 0 && std::abs(length - 1) < 1e-9 &&
                  std::isfinite(hit.position.x + hit.position.y + hit.position.z)))
                ++bad;
        }
        hits += good_hits;
        // Steps, counted by the scalar walk as if nothing were ever hit.
        for (std::size_t n = 0; n < count; n += 16) {
            Walk walk(map.to_cells * rays[n].origin + map.origin, map.to_cells * rays[n].direction);
            if (!walk.enter(rays[n].t_min, rays[n].t_max, bricks.size())) continue;
            std::size_t steps = 0;
            Block block{};
            do {
                block = findBlock(bricks, walk.cell(), walk.octant());
                walk.aim(block.low, block.high);
                ++steps;
            } while (steps <= most_steps && walk.advance(block.low, block.high, bricks.size()));
            ++walked;
            std::size_t seen = longest.load();
            while (steps > seen && !longest.compare_exchange_weak(seen, steps)) {
            }
        }
    });
    std::printf("  %zu hits, %zu bad; %zu walked to their end, the longest in %zu steps of at most %zu\n", hits.load(),
                bad.load(), walked.load(), longest.load(), most_steps);
    EXPECT_GT(hits, kRays / 20);
    EXPECT_EQ(bad, 0U);
    EXPECT_LE(longest, most_steps);
}

}  // namespace
}  // namespace stratum::march
