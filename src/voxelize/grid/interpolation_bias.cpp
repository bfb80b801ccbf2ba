#include "voxelize/grid/interpolation_bias.h"

#include <cmath>

namespace stratum::voxelize {
namespace {

constexpr int kStride[3] = {81, 9, 1};  // of samples

// Adds the part of one axis. The inner loops go along z, so that the compiler makes vectors of them.
template <int Axis>
void addAxis(const float* samples, int edge, CellNumbers& bias) {
    constexpr int kAlong = kStride[Axis];
    constexpr int kAside = kStride[(Axis + 1) % 3];
    constexpr int kAcross = kStride[(Axis + 2) % 3];
    // Second differences, summed over the four edges of a cell: at sample planes 1 to 7 of the axis.
    float second[9][9][9];
    for (int x = Axis == 0 ? 1 : 0; x < edge; ++x)
        for (int y = Axis == 1 ? 1 : 0; y < edge; ++y)
            for (int z = Axis == 2 ? 1 : 0; z < 8; ++z) {
                const float* s = samples + 81 * x + 9 * y + z;
                const auto edges = [s](int plane) {
                    const float* p = s + plane;
                    return p[0] + p[kAside] + p[kAcross] + p[kAside + kAcross];
                };
                second[x][y][z] = edges(-kAlong) - 2 * edges(0) + edges(kAlong);
            }
    constexpr float kShare = 1.0F / 48;
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y)
            for (int z = 0; z < 8; ++z) {
                const int n = Axis == 0 ? x : Axis == 1 ? y : z;
                const int below = n == 0 ? 1 : 0;  // at the leaf's ends both are the same
                const int above = n == (Axis == 2 ? 7 : edge - 1) ? 0 : 1;
                const float near =
                    second[x + (Axis == 0 ? below : 0)][y + (Axis == 1 ? below : 0)][z + (Axis == 2 ? below : 0)];
                const float far =
                    second[x + (Axis == 0 ? above : 0)][y + (Axis == 1 ? above : 0)][z + (Axis == 2 ? above : 0)];
                bias[x][y][z] += kShare * (std::abs(near) < std::abs(far) ? near : far);
            }
}

}  // namespace

void interpolationBias(const CellSamples& samples, CellNumbers& bias, int edge) {
    for (auto& plane : bias)
        for (auto& row : plane)
            for (float& value : row) value = 0;
    const float* const first = &samples[0][0][0];
    addAxis<0>(first, edge, bias);
    addAxis<1>(first, edge, bias);
    addAxis<2>(first, edge, bias);
}

}  // namespace stratum::voxelize
