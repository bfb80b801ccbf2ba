#include "report/level_set/interpolation_bias.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace stratum::report {
namespace {

using Field = std::function<double(double, double, double)>;

void sample(const Field& field, CellSamples& samples) {
    for (int x = 0; x < 9; ++x)
        for (int y = 0; y < 9; ++y)
            for (int z = 0; z < 9; ++z) samples[x][y][z] = static_cast<float>(field(x, y, z));
}

// The mean of the interpolated field less the true one over a cell, by a Gauss rule that is exact for cubics.
double meanDifference(const CellSamples& s, const Field& field, int x, int y, int z) {
    constexpr double kGauss[2] = {0.21132486540518713, 0.78867513459481287};
    double sum = 0;
    for (const double u : kGauss)
        for (const double v : kGauss)
            for (const double w : kGauss) {
                double interpolated = 0;
                for (int corner = 0; corner < 8; ++corner) {
                    const int dx = corner & 1;
                    const int dy = corner >> 1 & 1;
                    const int dz = corner >> 2;
                    interpolated += (dx != 0 ? u : 1 - u) * (dy != 0 ? v : 1 - v) * (dz != 0 ? w : 1 - w) *
                                    static_cast<double>(s[x + dx][y + dy][z + dz]);
                }
                sum += interpolated - field(x + u, y + v, z + w);
            }
    return sum / 8;
}

TEST(InterpolationBias, IsExactForQuadraticFields) {
    const Field field = [](double x, double y, double z) {
        return 0.3 * x * x - 0.2 * y * y + 0.11 * z * z + 0.4 * x * y - 0.3 * y * z + x - 2 * z + 1;
    };
    CellSamples samples;
    sample(field, samples);
    CellNumbers bias;
    interpolationBias(samples, 2, bias);
    for (int x = 0; x < 8; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z)
                ASSERT_NEAR(double(bias[x][y][z]), meanDifference(samples, field, x, y, z), 2e-6) << x << y << z;
}

TEST(InterpolationBias, TakesNoDifferenceAcrossACrease) {
    // Two layers of radius 4 that touch at z = 4: the groove between them is a crease.
    const Field field = [](double x, double, double z) {
        return std::hypot(x + 3, std::fmod(z, 4.0) == 0 && z > 0 && z < 8 ? 2.0 : std::fmod(z + 8, 4.0) - 2) - 4;
    };
    CellSamples samples;
    sample(field, samples);
    CellNumbers bias;
    interpolationBias(samples, 2, bias);
    for (int x = 0; x < 8; ++x)
        for (int z = 0; z < 8; ++z)
            // Radii from 3 to 11 voxels.
            EXPECT_NEAR(double(bias[x][3][z]), meanDifference(samples, field, x, 3, z), 0.008) << x << ' ' << z;
}

TEST(InterpolationBias, ReadsNothingBeyondItsCells) {
    const Field field = [](double x, double y, double z) { return x * x + 2 * y * y + z; };
    CellSamples samples;
    sample(field, samples);
    for (int a = 0; a < 9; ++a)
        for (int z = 0; z < 9; ++z) samples[8][a][z] = samples[a][8][z] = std::numeric_limits<float>::quiet_NaN();
    CellNumbers bias;
    interpolationBias(samples, 20, bias, 7);
    for (int x = 0; x < 7; ++x)
        for (int y = 0; y < 7; ++y)
            for (int z = 0; z < 8; ++z) ASSERT_NEAR(double(bias[x][y][z]), 6.0 / 12, 2e-6);
}

}  // namespace
}  // namespace stratum::report
