// Sections with corners and settled beads, against brute force in double.
#include "same_grids.h"
#include "settled_field.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/grid/voxelizer.h"

#include <gtest/gtest.h>
#include <openvdb/tools/Diagnostics.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace stratum::voxelize {
namespace {

using gcode::DepositModel;

struct Case {
    const char* name;
    std::function<void(gcode::Toolpath&)> build;
};

constexpr double kWidth = 0.45;
constexpr double kHeight = 0.2;

void parallelLines(gcode::Toolpath& toolpath, double spacing, double angle = 0.3) {
    for (int layer = 1; layer <= 3; ++layer)
        for (int n = 0; n < 6; ++n) {
            const double x = -std::sin(angle) * n * spacing;
            const double y = std::cos(angle) * n * spacing;
            test::addBead(toolpath, x, y, layer * kHeight, x + 4 * std::cos(angle), y + 4 * std::sin(angle),
                          layer * kHeight, kWidth, kHeight, static_cast<std::uint32_t>(layer));
        }
}

void zigzag(gcode::Toolpath& toolpath) {
    const double spacing = gcode::sectionArea(kWidth, kHeight) / kHeight;
    for (int layer = 1; layer <= 2; ++layer)
        for (int n = 0; n < 7; ++n) {
            const double z = layer * kHeight;
            const double from = n % 2 == 0 ? 0 : 3;
            test::addBead(toolpath, from, n * spacing, z, 3 - from, n * spacing, z, kWidth, kHeight,
                          static_cast<std::uint32_t>(layer));
            test::addBead(toolpath, 3 - from, n * spacing, z, 3 - from, (n + 1) * spacing, z, kWidth, kHeight,
                          static_cast<std::uint32_t>(layer));
        }
}

// Lines whose widths change along them, up and down, within reach of each other.
void tapers(gcode::Toolpath& toolpath) {
    for (int n = 0; n < 5; ++n) test::addBead(toolpath, 0, 0.42 * n, kHeight, 2, 0.42 * n, kHeight, kWidth, kHeight);
    test::addBead(toolpath, -1, -1, kHeight, 2, -1.5, kHeight, 1.2, kHeight);
    test::addBead(toolpath, 1, 3, kHeight, 1.1, 3.1, kHeight, 0.4, kHeight);
    toolpath.flow.resize(toolpath.beads.size());
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n) {
        const double most = std::min(gcode::beadLength(toolpath, toolpath.beads[n]), 0.3);
        toolpath.flow[n].widening = static_cast<float>((n % 2 == 0 ? 1 : -1) * (n % 5 == 4 ? 0 : most));
    }
}

const std::vector<Case>& cases() {
    static const std::vector<Case> kCases = {
        {"just_closed", [](auto& t) { parallelLines(t, gcode::sectionArea(kWidth, kHeight) / kHeight); }},
        {"open", [](auto& t) { parallelLines(t, 0.42); }},
        {"apart", [](auto& t) { parallelLines(t, 0.5); }},
        {"too_close", [](auto& t) { parallelLines(t, 0.3); }},
        {"zigzag", zigzag},
        {"tapers", tapers},
        {"crossing", [](auto& t) { t = study::crossedLines(kWidth, kHeight); }},
        {"fan",
         [](auto& t) {
             for (int n = 0; n < 9; ++n)
                 test::addBead(t, 0, 0, kHeight, 4 * std::cos(0.12 * n), 4 * std::sin(0.12 * n), kHeight, kWidth,
                               kHeight);
         }},
        {"circles",
         [](auto& t) {
             for (int n = 1; n < 7; ++n)
                 test::addArc(t, 0.2, 0.1, 0.41 * n, 0.7, 2 * std::numbers::pi, kHeight, kHeight, kWidth, kHeight);
         }},
        {"arcs",
         [](auto& t) {
             for (int n = 1; n < 7; ++n) test::addArc(t, 0, 0, 0.41 * n, 0.3, 1.9, kHeight, kHeight, kWidth, kHeight);
         }},
        {"point_beside_line",
         [](auto& t) {
             test::addBead(t, 0, 0, kHeight, 3, 0, kHeight, kWidth, kHeight);
             test::addBead(t, 1, 0.41, kHeight, 1, 0.41, kHeight, kWidth, kHeight);
         }},
        {"hairpin",
         [](auto& t) {
             test::addBead(t, 0, 0, kHeight, 3, 0, kHeight, kWidth, kHeight);
             test::addBead(t, 3, 0, kHeight, 0, 0.2, kHeight, kWidth, kHeight);
         }},
        {"on_itself",
         [](auto& t) {
             for (int n = 0; n < 2; ++n) test::addBead(t, 0, 0, kHeight, 3, 1, kHeight, kWidth, kHeight);
         }},
        {"random",
         [](auto& t) {
             std::mt19937 random(5);
             std::uniform_real_distribution<double> at(0, 4);
             for (int n = 0; n < 40; ++n) {
                 const int layer = 1 + n / 20;
                 test::addBead(t, at(random), at(random), layer * kHeight, at(random), at(random), layer * kHeight,
                               0.3 + 0.1 * at(random), kHeight, static_cast<std::uint32_t>(layer));
             }
         }},
    };
    return kCases;
}

Lattice latticeOf(const gcode::Toolpath& toolpath, double voxel) {
    LatticeRequest request;
    request.voxel_size = voxel;
    const auto beads = test::allBeads(toolpath);
    return chooseLattice(toolpath, beads, boundsOf(toolpath, beads), request);
}

struct Model {
    DepositModel::Beads beads;
    double corner_fraction;
};

class Deposit : public testing::TestWithParam<Model> {
protected:
    gcode::Toolpath make(const Case& one) const {
        gcode::Toolpath toolpath;
        one.build(toolpath);
        toolpath.deposit.beads = GetParam().beads;
        toolpath.deposit.corner_fraction = GetParam().corner_fraction;
        return toolpath;
    }
};

INSTANTIATE_TEST_SUITE_P(
    Models, Deposit,
    testing::Values(Model{DepositModel::Beads::capsule, 0.5}, Model{DepositModel::Beads::capsule, 0.05},
                    Model{DepositModel::Beads::grooves, 1}, Model{DepositModel::Beads::settled, 0.6},
                    Model{DepositModel::Beads::grooves, 0.1}),
    [](const auto& model) {
        return std::string(model.param.beads == DepositModel::Beads::capsule ? "Capsule" : "Settled") +
               std::to_string(std::lround(100 * model.param.corner_fraction));
    });

TEST_P(Deposit, AgreesWithBruteForce) {
    for (const Case& one : cases())
        for (const double voxel : {0.05, 0.02}) {
            gcode::Toolpath toolpath = make(one);
            // Brute force knows no swell: study/geometry/exact_solid.h holds that to its formulas.
            if (toolpath.deposit.swells()) toolpath.deposit.beads = DepositModel::Beads::grooves;
            const test::SettledField brute(toolpath);
            const auto beads = test::allBeads(toolpath);
            const Lattice lattice = latticeOf(toolpath, voxel);
            const auto grid = voxelize(toolpath, beads, lattice);
            std::size_t n = 0;
            double worst = 0;
            std::size_t wrong_sign = 0;
            for (auto voxel_on = grid->cbeginValueOn(); voxel_on; ++voxel_on) {
                if (++n % 7 != 0) continue;
                const openvdb::Vec3d p = grid->indexToWorld(voxel_on.getCoord());
                const double expected = brute(p[0], p[1], p[2]);
                const auto value = static_cast<double>(*voxel_on);
                if (expected > 1e-6) worst = std::max(worst, std::abs(value - expected));
                if (std::abs(expected) > 1e-6 && (value < 0) != (expected < 0)) ++wrong_sign;
            }
            EXPECT_LT(worst, 2e-5) << one.name << " at " << voxel;
            EXPECT_EQ(wrong_sign, 0U) << one.name << " at " << voxel;
            EXPECT_GT(n, 1000U);
        }
}

TEST_P(Deposit, StepsAndThreadsGiveTheSameBytes) {
    const gcode::Toolpath toolpath = make(cases()[5]);
    const auto beads = test::allBeads(toolpath);
    const Lattice lattice = latticeOf(toolpath, 0.02);
    const auto whole = voxelize(toolpath, beads, lattice);
    Voxelizer stepwise(toolpath, beads, lattice);
    for (const std::uint32_t end : {3U, 10U, 17U}) {
        const auto grown = stepwise.printUntil(end);
        const auto fresh = Voxelizer(toolpath, beads, lattice).printUntil(end);
        test::expectSame(*fresh, *grown);
    }
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    const auto alone = voxelize(toolpath, beads, lattice);
    test::expectSame(*whole, *alone);
}

TEST_P(Deposit, ASlopedBeadHasTheSameSection) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 0, 0, 1, 5, 1, 1.3, kWidth, kHeight);
    test::addArc(toolpath, 0, 3, 2, 0.2, 1.5, 1, 1.2, kWidth, kHeight);
    toolpath.deposit.corner_fraction = GetParam().corner_fraction;
    const auto beads = test::allBeads(toolpath);
    const auto grid = voxelize(toolpath, beads, latticeOf(toolpath, 0.02));
    const BeadField line(toolpath, toolpath.beads[0]);
    const BeadField helix(toolpath, toolpath.beads[1]);
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const openvdb::Vec3d p = grid->indexToWorld(voxel.getCoord());
        const double expected = std::min(line.distance(p[0], p[1], p[2]), helix.distance(p[0], p[1], p[2]));
        ASSERT_NEAR(*voxel, expected, 2e-5);
    }
    // Area of the section by counting, across the middle of the line.
    const double length = std::hypot(5, 1);
    double area = 0;
    constexpr double kStep = 0.001;
    for (double side = -0.4; side < 0.4; side += kStep)
        for (double z = 0.9; z < 1.3; z += kStep)
            if (line.distance(2.5 - side / length, 0.5 + side * 5 / length, z) < 0) area += kStep * kStep;
    const double cosine = length / std::hypot(length, 0.3);
    // The reach below a sloped bead adds 2 % of its height at its flats.
    EXPECT_NEAR(area * cosine, gcode::sectionArea(kWidth, kHeight) + 0.02 * kHeight * 2 * line.halfFlat(), 2e-3);
}

TEST(DepositModel, AStadiumIsTheDefaultToTheBit) {
    gcode::Toolpath toolpath;
    zigzag(toolpath);
    const auto beads = test::allBeads(toolpath);
    const Lattice lattice = latticeOf(toolpath, 0.05);
    const auto before = voxelize(toolpath, beads, lattice);
    toolpath.deposit.corner_mm = 5;  // no more than half the height
    const auto after = voxelize(toolpath, beads, lattice);
    test::expectSame(*before, *after);
}

TEST(DepositModel, SharpCornersAreABox) {
    gcode::Toolpath toolpath;
    test::addBead(toolpath, 0, 0, kHeight, 3, 0, kHeight, kWidth, kHeight);
    toolpath.deposit.corner_fraction = 0;
    toolpath.deposit.beads = DepositModel::Beads::grooves;
    const BeadField field(toolpath, toolpath.beads[0]);
    const double width = gcode::sectionArea(kWidth, kHeight) / kHeight;
    EXPECT_NEAR(field.distance(1, width / 2, kHeight / 2), 0, 1e-8);
    EXPECT_NEAR(field.distance(1, width / 2 + 0.03, kHeight + 0.04), 0.05, 1e-8);
    EXPECT_NEAR(field.distance(1, 0, kHeight / 2), -kHeight / 2, 1e-8);
    const auto beads = test::allBeads(toolpath);
    const auto grid = voxelize(toolpath, beads, latticeOf(toolpath, 0.02));
    for (auto voxel = grid->cbeginValueOn(); voxel; ++voxel) {
        const openvdb::Vec3d p = grid->indexToWorld(voxel.getCoord());
        ASSERT_NEAR(*voxel, field.distance(p[0], p[1], p[2]), 1e-6);
    }
}

TEST(DepositModel, BetweenParallelBeadsTheSlopeIsOne) {
    for (const double spacing : {0.38, 0.4, 0.41, 0.42, 0.44}) {
        gcode::Toolpath toolpath;
        parallelLines(toolpath, spacing, 0);
        toolpath.deposit.beads = DepositModel::Beads::grooves;
        const test::SettledField field(toolpath);
        // Across the beads, over the top layer and into its grooves.
        double steepest = 0;
        constexpr double kStep = 1e-4;
        for (double y = 0; y < 5 * spacing; y += 0.003)
            for (double z = 0.5; z < 0.75; z += 0.01) {
                const double here = field(2, y, z);
                if (here < 0) continue;
                const double gy = (field(2, y + kStep, z) - field(2, y - kStep, z)) / (2 * kStep);
                const double gz = (field(2, y, z + kStep) - field(2, y, z - kStep)) / (2 * kStep);
                steepest = std::max(steepest, std::hypot(gy, gz));
            }
        EXPECT_LE(steepest, 1 + 1e-3) << spacing;
        EXPECT_GE(steepest, 0.99) << spacing;
    }
}

TEST(DepositBalance, FedIsLaidAndSurplus) {
    for (const double corner : {1.0, 0.5}) {
        gcode::Toolpath toolpath;
        zigzag(toolpath);
        toolpath.deposit.beads = DepositModel::Beads::grooves;
        toolpath.deposit.corner_fraction = corner;
        const auto beads = test::allBeads(toolpath);
        const Lattice lattice = latticeOf(toolpath, 0.02);
        Voxelizer voxelizer(toolpath, beads, lattice);
        const auto grid = voxelizer.printAll();
        const DepositBalance balance = voxelizer.balance();
        EXPECT_NEAR(balance.all.fed, gcode::beadVolume(toolpath), 1e-6);
        EXPECT_NEAR(balance.all.laid, enclosedVolume(*grid), 2e-3 * balance.all.fed);
        double layers = 0;
        for (const DepositShare& layer : balance.layers) layers += layer.laid;
        EXPECT_NEAR(layers, balance.all.laid, 1e-6);
        EXPECT_EQ(balance.features[static_cast<std::size_t>(gcode::Feature::unknown)].laid, balance.all.laid);
        // Without settling the same beads hold less.
        toolpath.deposit.beads = DepositModel::Beads::capsule;
        Voxelizer capsules(toolpath, beads, lattice);
        capsules.printAll();
        EXPECT_LT(capsules.balance().all.laid, balance.all.laid - 0.01 * balance.all.fed);
    }
}

}  // namespace
}  // namespace stratum::voxelize
