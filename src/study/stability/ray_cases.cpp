// Rays that graze, start and end where rays should not, against surfaces whose hits are known on paper.
//
// A plane's distances are linear, so that trilinear interpolation has its zero exactly there: what is left are
// roundings of samples and of t. A ball's are not: its trilinear zero is off by at most voxel^2 / 8 times the sum of
// the second derivatives, 2 / R.
#include "march/brick/brick_intersector.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <glm/geometric.hpp>

#include <algorithm>
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
}

}  // namespace

std::vector<StabilityCase> rayCases() {
    std::vector<StabilityCase> cases;
    addPlanes(cases);
    addBalls(cases);
    return cases;
}

}  // namespace stratum::study
