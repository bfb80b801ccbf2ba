// Rays that graze, start and end where rays should not, against surfaces whose hits are known on paper.
//
// A plane's distances are linear, so that trilinear interpolation has its zero exactly there: what is left are
// roundings of samples and of t. A ball's are not: its trilinear zero is off by at most voxel^2 / 8 times the sum of
// the second derivatives, 2 / R.
#include "march/brick/brick_intersector.h"
#include "march/reference/sphere_intersector.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace stratum::study {
namespace {

constexpr double kRayVoxel = 0.1;
constexpr double kBand = 3 * kRayVoxel;
// A sample is a float within the band; between two of them a zero moves by no more than their rounding.
constexpr double kSample = kBand * 0x1p-24 * 2;

// The half space below `offset` along the unit vector `normal`, in a box of 64^3 voxels about the origin.
openvdb::FloatGrid::Ptr plane(const openvdb::Vec3d& normal, double offset) {
    openvdb::initialize();
    auto grid = openvdb::FloatGrid::create(static_cast<float>(kBand));
    grid->setTransform(openvdb::math::Transform::createLinearTransform(kRayVoxel));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    grid->setName("surface");
    auto accessor = grid->getAccessor();
    for (int x = -32; x <= 32; ++x)
        for (int y = -32; y <= 32; ++y)
            for (int z = -32; z <= 32; ++z) {
                const double d = kRayVoxel * normal.dot(openvdb::Vec3d(x, y, z)) - offset;
                if (std::abs(d) < kBand)
                    accessor.setValue(openvdb::Coord(x, y, z), static_cast<float>(d));
                else if (d < 0)
                    accessor.setValueOff(openvdb::Coord(x, y, z), static_cast<float>(-kBand));
            }
    return grid;
}

openvdb::FloatGrid::Ptr ball(float radius = 2, const openvdb::Vec3f& center = openvdb::Vec3f(0), float voxel = 0.1F) {
    openvdb::initialize();
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius, center, voxel);
    grid->setName("surface");
    return grid;
}

// How far a ball's trilinear zero is off, and the roundings of its samples.
constexpr double kBallBend = kRayVoxel * kRayVoxel / 8 * 2 / 2.0 + kSample;

StabilityCase rays(std::string name, std::string quantity, double tolerance, std::string why,
                   std::function<double()> measure) {
    return {"rays", std::move(name), std::move(quantity), tolerance, std::move(why), std::move(measure)};
}

// A level set with its tracer, in floats: nothing but the method is tested.
class TracedField {
public:
    explicit TracedField(const openvdb::FloatGrid& grid)
        : intersector_(march::makeBrickIntersector(grid, march::BrickValues::Float32)),
          tracer_(intersector_->makeTracer()) {}
    trace::Tracer* operator->() const { return tracer_.get(); }
    double surfaceOffset() const { return intersector_->surfaceOffset(); }

private:
    std::unique_ptr<trace::Intersector> intersector_;
    std::unique_ptr<trace::Tracer> tracer_;
};

glm::dvec3 randomDirection(std::mt19937& random) {
    std::normal_distribution<double> normal;
    return glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
}

// Rays that come in to a level plane at this angle; the largest error of the height at which they are said to hit.
double grazing(double angle, double offset) {
    const TracedField field(*plane({0, 0, 1}, offset));
    double largest = 0;
    for (int n = 0; n < 200; ++n) {
        const double turn = 0.031 * n;
        const glm::dvec3 d{std::cos(turn) * std::cos(angle), std::sin(turn) * std::cos(angle), -std::sin(angle)};
        const glm::dvec3 target{0.37 * std::sin(1.7 * n), 0.53 * std::cos(2.3 * n), offset};
        trace::Hit hit;
        if (!field->intersect({target - 2.0 * d, d}, hit)) return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs(hit.position.z - offset));
    }
    return largest;
}

// A ray straight down along x = y = `at` voxels on a plane; some at lattice planes and edges.
double downAt(double at) {
    const TracedField field(*plane({0, 0, 1}, 0.034));
    double largest = 0;
    for (const double other : {0.0, 0.5, 1.0, at})
        for (const double zero : {0.0, -0.0, 1e-310, -5e-324}) {
            trace::Hit hit;
            if (!field->intersect({{at * kRayVoxel, other * kRayVoxel, 5}, {zero, zero, -1}}, hit))
                return std::numeric_limits<double>::infinity();
            largest = std::max(largest, std::abs(hit.position.z - 0.034));
        }
    return largest;
}

// The largest error of t, less the way, of rays to the middle of a ball from this far.
double fromAfar(double away) {
    const TracedField field(*ball());
    std::mt19937 random(3);
    double largest = 0;
    for (int n = 0; n < 500; ++n) {
        const glm::dvec3 out = randomDirection(random);
        trace::Hit near;
        trace::Hit far;
        if (!field->intersect({3.0 * out, -out}, near) || !field->intersect({away * out, -out}, far))
            return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs((far.t - away) - (near.t - 3)));
    }
    return largest;
}

// Rays that must meet a ball: their share that does not. Aim: where, as a part of the radius, they pass the middle.
double missesOfABall(double aim) {
    const TracedField field(*ball());
    std::mt19937 random(5);
    int missed = 0;
    constexpr int kRays = 20000;
    for (int n = 0; n < kRays; ++n) {
        const glm::dvec3 d = randomDirection(random);
        const glm::dvec3 side = glm::normalize(glm::cross(d, randomDirection(random)));
        missed += field->occluded({2 * aim * side - 5.0 * d, d}) ? 0 : 1;
    }
    return static_cast<double>(missed) / kRays;
}

// Rays from inside a closed ball, along lattice planes, edges and at random: the share that gets out.
double leaks(bool on_lattice) {
    const TracedField field(*ball());
    std::mt19937 random(6);
    std::uniform_real_distribution<double> where(-1, 1);
    int out = 0;
    constexpr int kRays = 100000;
    for (int n = 0; n < kRays; ++n) {
        trace::Ray ray{{where(random), where(random), where(random)}, randomDirection(random)};
        if (on_lattice) {
            ray.origin = kRayVoxel * glm::round(ray.origin / kRayVoxel);
            ray.direction = glm::dvec3(0);
            ray.direction[n % 3] = n % 2 == 0 ? 1 : -1;
            if (n % 4 == 0) ray.direction[(n + 1) % 3] = 1;
            if (n % 8 == 0) ray.direction[(n + 2) % 3] = -1;
            ray.direction = glm::normalize(ray.direction);
        }
        out += field->occluded(ray) ? 0 : 1;
    }
    return static_cast<double>(out) / kRays;
}

// Rays that leave a ball this far from the origin at their hit: the share that meets it again at once.
double meetingsAgain(double away) {
    const auto grid = ball();
    grid->transform().postTranslate(openvdb::Vec3d(away, -away, away));
    const TracedField field(*grid);
    const glm::dvec3 center(away, -away, away);
    std::mt19937 random(7);
    int met = 0;
    constexpr int kRays = 20000;
    for (int n = 0; n < kRays; ++n) {
        const glm::dvec3 out = randomDirection(random);
        trace::Hit hit;
        if (!field->intersect({center + 5.0 * out, -out}, hit)) return std::numeric_limits<double>::infinity();
        // Between the normal and nearly along the surface.
        const glm::dvec3 leave = glm::normalize(hit.normal + 0.95 * randomDirection(random));
        met += field->occluded({hit.position + field.surfaceOffset() * hit.normal, leave}) ? 1 : 0;
    }
    return static_cast<double>(met) / kRays;
}

// Whether one ray and a stream of rays give the same bits: the share that does not.
double streamDiffers() {
    const TracedField field(*ball());
    std::mt19937 random(8);
    std::uniform_real_distribution<double> where(-2.5, 2.5);
    std::vector<trace::Ray> all;
    all.reserve(5000);
    for (int n = 0; n < 5000; ++n)
        all.push_back({{where(random), where(random), where(random)}, randomDirection(random)});
    std::vector<trace::Hit> hits(all.size());
    field->intersectStream(all, hits);
    int other = 0;
    for (std::size_t n = 0; n < all.size(); ++n) {
        trace::Hit hit;
        if (!field->intersect(all[n], hit)) hit.t = std::numeric_limits<double>::infinity();
        other += std::bit_cast<std::uint64_t>(hit.t) != std::bit_cast<std::uint64_t>(hits[n].t) ? 1 : 0;
    }
    return other;
}

// Intervals that end or begin just before and just behind the surface: answers that are wrong. "Just" is the rounding
// of t: eight times 2^-53 of the way.
double wrongIntervals() {
    const TracedField field(*plane({0, 0, 1}, 0.034));
    const trace::Ray down{{0.11, 0.23, 1}, {0, 0, -1}};
    trace::Hit hit;
    if (!field->intersect(down, hit)) return 99;
    int wrong = 0;
    const auto expect = [&](double t_min, double t_max, bool expected) {
        trace::Ray ray = down;
        ray.t_min = t_min;
        ray.t_max = t_max;
        wrong += field->occluded(ray) != expected ? 1 : 0;
    };
    const double rounding = 8 * 0x1p-53 * hit.t;
    expect(0, hit.t - rounding, false);
    expect(0, hit.t + rounding, true);
    expect(hit.t - rounding, 10, true);
    expect(hit.t + rounding, 10, false);
    expect(hit.t - rounding, hit.t + rounding, true);
    expect(5, 4, false);
    return wrong;
}

// The largest difference, mm, between a ball's hits and the paper's, for a ball of this voxel (of world units).
double scaledBall(double scale) {
    const auto grid = ball(static_cast<float>(2 * scale), openvdb::Vec3f(0), static_cast<float>(kRayVoxel * scale));
    const TracedField field(*grid);
    std::mt19937 random(9);
    double largest = 0;
    for (int n = 0; n < 1000; ++n) {
        const glm::dvec3 out = randomDirection(random);
        trace::Hit hit;
        if (!field->intersect({scale * 5.0 * out, -out}, hit)) return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs(hit.t / scale - 3));
    }
    return largest;
}

double tiltedPlane() {
    const openvdb::Vec3d normal = openvdb::Vec3d(1, 2, 3).unit();
    const TracedField field(*plane(normal, 0.05));
    std::mt19937 random(10);
    double largest = 0;
    for (int n = 0; n < 5000; ++n) {
        const glm::dvec3 d = randomDirection(random);
        if (std::abs(normal.dot(openvdb::Vec3d(d.x, d.y, d.z))) < 0.2) continue;
        trace::Hit hit;
        if (!field->intersect({-1.5 * d, d}, hit)) return std::numeric_limits<double>::infinity();
        const glm::dvec3& p = hit.position;
        largest = std::max(largest, std::abs(normal.dot(openvdb::Vec3d(p.x, p.y, p.z)) - 0.05));
    }
    return largest;
}

double normalOfATiltedPlane() {
    const openvdb::Vec3d normal = openvdb::Vec3d(-2, 1, 4).unit();
    const TracedField field(*plane(normal, 0.02));
    double largest = 0;
    for (int n = 0; n < 500; ++n) {
        trace::Hit hit;
        const trace::Ray ray{{0.9 * std::sin(3.1 * n), 0.9 * std::cos(1.3 * n), 3}, {0, 0, -1}};
        if (!field->intersect(ray, hit)) return std::numeric_limits<double>::infinity();
        const glm::dvec3 exact(normal[0], normal[1], normal[2]);
        largest = std::max(largest, glm::length(hit.normal - exact));
    }
    return largest;
}

// Of two ways to trace, the largest difference of t where both hit head on, mm.
double againstSphereTracing() {
    const auto grid = ball();
    const auto brick = march::makeBrickIntersector(*grid, march::BrickValues::Float32);
    const auto other = march::makeSphereIntersector(grid);
    const auto a = brick->makeTracer();
    const auto b = other->makeTracer();
    std::mt19937 random(11);
    double largest = 0;
    for (int n = 0; n < 5000; ++n) {
        const glm::dvec3 out = randomDirection(random);
        trace::Hit exact;
        trace::Hit near;
        if (!a->intersect({5.0 * out, -out}, exact) || !b->intersect({5.0 * out, -out}, near))
            return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs(exact.t - near.t));
    }
    return largest;
}

void addPlanes(std::vector<StabilityCase>& cases) {
    for (const double angle : {1.5707, 1e-2, 1e-4})
        cases.push_back(rays(fmt::format("plane at {:g} rad", angle), "largest error of the height, mm", kSample,
                             "two float samples of the band, each rounded by 2^-24",
                             [angle] { return grazing(angle, 0.034); }));
    cases.push_back(rays("plane at 0.01 rad, on a lattice plane", "largest error of the height, mm", kSample,
                         "two float samples of the band, each rounded by 2^-24", [] { return grazing(1e-2, 0.1); }));
    for (const double at : {0.0, 3.0, 0.5, 7.0000001})
        cases.push_back(rays(fmt::format("axis-parallel at {:g} voxels", at), "largest error of the height, mm",
                             kSample, "two float samples of the band, each rounded by 2^-24",
                             [at] { return downAt(at); }));
    cases.push_back(rays("tilted plane from random directions", "largest distance from the plane, mm", 4 * kSample,
                         "eight float samples of the band, each rounded by 2^-24", tiltedPlane));
    cases.push_back(rays("normal of a tilted plane", "largest length of the difference",
                         2 * std::sqrt(3.0) * kSample / kRayVoxel, "two samples' roundings over a voxel, on three axes",
                         normalOfATiltedPlane));
    cases.push_back(rays("intervals that end on the surface", "wrong answers", 0,
                         "8 roundings of 2^-53 of t decide on which side an end lies", wrongIntervals));
}

void addBalls(std::vector<StabilityCase>& cases) {
    for (const double away : {1e3, 1e6, 1e9})
        cases.push_back(rays(
            fmt::format("eye {:g} mm away", away), "largest change of the hit, mm", 8 * 0x1p-53 * away + 1e-12,
            "t, origin and direction are doubles: 8 roundings of 2^-53 of the way", [away] { return fromAfar(away); }));
    for (const double scale : {1e-3, 1e6})
        cases.push_back(rays(fmt::format("world units of {:g} mm", 1 / scale), "largest error of t, mm", kBallBend,
                             "voxel^2 / 8 times the second derivatives 2 / R, and samples' roundings",
                             [scale] { return scaledBall(scale); }));
    cases.push_back(rays("tangent, a voxel inside", "share of rays that miss", 0,
                         "a voxel is more than the trilinear zero is off (voxel^2 / 4R)",
                         [] { return missesOfABall((2 - kRayVoxel) / 2); }));
    cases.push_back(rays("tangent, a hundredth of a voxel outside", "share of rays that hit", 0,
                         "the trilinear interpolant of a convex distance is nowhere below it",
                         [] { return 1 - missesOfABall((2 + 0.01 * kRayVoxel) / 2); }));
    cases.push_back(rays("out of a closed ball", "share of rays that leak", 0,
                         "neighbouring cells see the same bits on their face", [] { return leaks(false); }));
    cases.push_back(rays("out of a closed ball, on the lattice", "share of rays that leak", 0,
                         "neighbouring cells see the same bits on their face", [] { return leaks(true); }));
    for (const double away : {0.0, 1e5, 1e9})
        cases.push_back(rays(fmt::format("leaving a surface {:g} mm from the origin", away),
                             "share of rays that meet it again", 0,
                             "the offset is a thousandth of a voxel, or four roundings of the place",
                             [away] { return meetingsAgain(away); }));
    cases.push_back(rays("one by one or in a stream", "rays whose bits differ", 0,
                         "vector and scalar code do the same operations in the same order", streamDiffers));
    cases.push_back(
        rays("against sphere tracing", "largest difference of t, mm", 2e-3 * kRayVoxel,
             "it ends within a thousandth of a voxel; a ball's field has a slope above 1/2 along its normal",
             againstSphereTracing));
}

}  // namespace

std::vector<StabilityCase> rayCases() {
    std::vector<StabilityCase> cases;
    addPlanes(cases);
    addBalls(cases);
    return cases;
}

}  // namespace stratum::study
