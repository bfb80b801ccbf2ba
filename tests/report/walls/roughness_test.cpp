#include "report/walls/roughness.h"

#include "reported_print.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace stratum::report {
namespace {

using test::addBead;
using test::layeredLattice;
using test::numberOf;
using test::reportOfAll;

// The side of a stadium is y = sqrt(r^2 - z^2), r = h / 2, over |z| < r. Its mean is pi r / 4 and it is symmetric, so
// the least squares line over whole layers is the mean. y is above the mean within |z| < a = r sqrt(1 - pi^2 / 16), so
//     Ra = (1 / 2r) int |y - pi r / 4| = (2 / 2r) int_{-a}^{a} (y - pi r / 4) dz
//        = (1 / r) [a sqrt(r^2 - a^2) + r^2 asin(a / r) - 2 a pi r / 4], with sqrt(r^2 - a^2) = pi r / 4.
double stadiumRa(double height) {
    const double r = height / 2;
    const double mean = std::numbers::pi / 4;
    const double a = std::sqrt(1 - mean * mean);
    return r * (a * mean + std::asin(a) - 2 * a * mean);
}

gcode::Toolpath wall(double height, int layers) {
    gcode::Toolpath toolpath;
    for (int n = 1; n <= layers; ++n)
        addBead(toolpath, 0, 0.013, n * height, 20, 0.013, n * height, 2.5 * height, height,
                static_cast<std::uint32_t>(n));
    return toolpath;
}

// Ra and Rz of values at equal steps, about their least squares line.
std::pair<double, double> roughnessOfProfile(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    double mean = 0;
    double moment = 0;
    double square = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
        const double t = static_cast<double>(n) - 0.5 * (count - 1);
        mean += values[n] / count;
        moment += values[n] * t;
        square += t * t;
    }
    double sum = 0;
    double low = 0;
    double high = 0;
    for (std::size_t n = 0; n < values.size(); ++n) {
        const double off = values[n] - mean - moment / square * (static_cast<double>(n) - 0.5 * (count - 1));
        sum += std::abs(off) / count;
        low = std::min(low, off);
        high = std::max(high, off);
    }
    return {sum, high - low};
}

TEST(Roughness, OfStackedStadiums) {
    EXPECT_NEAR(stadiumRa(1), 0.0907, 5e-5);
    for (const double height : {0.1, 0.2, 0.35}) {
        const double exact = 1e3 * stadiumRa(height);
        for (const int voxels : {4, 8}) {
            const PrintReport report = reportOfAll(wall(height, 24), layeredLattice(height, voxels));
            EXPECT_NEAR(numberOf(report, "roughness_ra"), exact, 0.02 * exact) << height << " " << voxels;
            // Voxels blunt the grooves, which end in a cusp.
            const double rz = numberOf(report, "roughness_rz");
            EXPECT_LT(rz, 500 * height * 1.001);
            EXPECT_GT(rz, 500 * height * 0.93);
        }
    }
}

// Wherever the wall lies on the lattice, and along whatever direction.
TEST(Roughness, OfAWallAnywhere) {
    const double exact = 1e3 * stadiumRa(0.2);
    for (const int voxels : {4, 8}) {
        double worst = 0;
        double highest = 0;
        double lowest = 1;
        for (const double turned : {0.0, 0.3, 0.7853981633974483})
            for (const double offset : {0.0, 0.13, 0.29, 0.5, 0.71, 0.87}) {
                gcode::Toolpath toolpath;
                const double across = offset * 0.2 / voxels;
                const double x = std::cos(turned);
                const double y = std::sin(turned);
                for (int n = 1; n <= 24; ++n)
                    addBead(toolpath, -y * across, x * across, n * 0.2, 20 * x - y * across, 20 * y + x * across,
                            n * 0.2, 0.5, 0.2, static_cast<std::uint32_t>(n));
                const PrintReport report = reportOfAll(toolpath, layeredLattice(0.2, voxels));
                worst = std::max(worst, std::abs(numberOf(report, "roughness_ra") / exact - 1));
                highest = std::max(highest, numberOf(report, "roughness_rz") / 100);
                lowest = std::min(lowest, numberOf(report, "roughness_rz") / 100);
            }
        RecordProperty("worst_ra_" + std::to_string(voxels), std::to_string(worst));
        RecordProperty("rz_" + std::to_string(voxels), std::to_string(lowest) + " " + std::to_string(highest));
        EXPECT_LT(worst, 0.03);
        EXPECT_LT(highest, 1.02);
        EXPECT_GT(lowest, 0.93);
    }
}

TEST(Roughness, ALeaningWallIsNoRougher) {
    gcode::Toolpath toolpath;
    for (int n = 1; n <= 24; ++n)
        addBead(toolpath, 0, 0.004 * n, n * 0.2, 20, 0.004 * n, n * 0.2, 0.5, 0.2, static_cast<std::uint32_t>(n));
    const double exact = 1e3 * stadiumRa(0.2);
    const PrintReport report = reportOfAll(toolpath, layeredLattice(0.2, 8));
    EXPECT_NEAR(numberOf(report, "roughness_ra"), exact, 0.03 * exact);
}

// A wall whose layers step in by half their height, about 27 degrees off the vertical: measured on the level set of the
// whole print it came out a quarter too smooth at 4 voxels a layer.
TEST(Roughness, OfAWallThatSteps) {
    constexpr double kHeight = 0.2;
    constexpr double kStep = 0.1;
    gcode::Toolpath toolpath;
    for (int n = 1; n <= 24; ++n)
        addBead(toolpath, 0, kStep * n, n * kHeight, 20, kStep * n, n * kHeight, 0.5, kHeight,
                static_cast<std::uint32_t>(n));
    // On both sides the profile is a row of half discs and of steps; over a sampling length of four layers, from a
    // plane between layers on.
    std::vector<double> profile;
    constexpr int kPoints = 1000;
    for (int n = 0; n < 4 * kPoints; ++n) {
        const double z = (n % kPoints + 0.5) / kPoints - 0.5;  // of a layer
        profile.push_back(kHeight * std::sqrt(0.25 - z * z) + kStep * (n / kPoints));
    }
    const auto [ra, rz] = roughnessOfProfile(profile);
    for (const int voxels : {2, 4, 8}) {
        const PrintReport report = reportOfAll(toolpath, layeredLattice(kHeight, voxels));
        EXPECT_NEAR(numberOf(report, "roughness_ra"), 1e3 * ra, 0.04 * 1e3 * ra) << voxels;
        EXPECT_NEAR(numberOf(report, "roughness_rz"), 1e3 * rz, 0.17 * 1e3 * rz) << voxels;
    }
}

TEST(Roughness, SamplingLengthsAreWholeLayers) {
    EXPECT_DOUBLE_EQ(samplingLength(0.2), 0.8);
    EXPECT_NEAR(samplingLength(static_cast<double>(0.4F)), 0.8, 1e-6);
    EXPECT_DOUBLE_EQ(samplingLength(0.1), 0.3);
    EXPECT_DOUBLE_EQ(samplingLength(0.35), 2 * 0.35);
    EXPECT_DOUBLE_EQ(samplingLength(5), 10);
}

TEST(Roughness, TooLowAWallHasNone) {
    const PrintReport report = reportOfAll(wall(0.2, 3), layeredLattice(0.2, 4));
    EXPECT_EQ(report.find("roughness_ra"), nullptr);
}

}  // namespace
}  // namespace stratum::report
