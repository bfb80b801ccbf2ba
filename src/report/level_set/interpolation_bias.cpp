#include "report/level_set/interpolation_bias.h"

#include <algorithm>
#include <cmath>

namespace stratum::report {
namespace {

constexpr float kShare = 1.0F / 48;  // a twelfth, of the mean over four edges

// Of a round side whose radius is two voxels, voxels. What bends more is a corner that samples don't resolve.
constexpr float kMost = 0.39F;

// The smaller of two sums over four edges, if it is at most `most`.
float chosen(float a, float b, float most) {
    const float size = std::min(std::abs(a), std::abs(b));
    const float smaller = std::abs(a) < std::abs(b) ? a : b;
    return size < most ? kShare * smaller : 0.0F;
}

// Each of these sets or adds the part of one axis: samples are summed over the four edges of a cell along that axis,
// then second differences are taken at the inner sample planes. The inner loops go along z, so that the compiler makes
// vectors.

void setAlongX(const CellSamples& s, int edge, float most, CellNumbers& bias) {
    float sums[9][8];
    float second[9][8];  // of one y
    for (int y = 0; y < edge; ++y) {
        for (int x = 0; x <= edge; ++x)
            for (int z = 0; z < 8; ++z)
                sums[x][z] = s[x][y][z] + s[x][y][z + 1] + (s[x][y + 1][z] + s[x][y + 1][z + 1]);
        for (int x = 1; x < edge; ++x)
            for (int z = 0; z < 8; ++z) second[x][z] = sums[x - 1][z] - 2 * sums[x][z] + sums[x + 1][z];
        for (int x = 0; x < edge; ++x) {
            const float(&low)[8] = second[x == 0 ? 1 : x];
            const float(&high)[8] = second[x == edge - 1 ? x : x + 1];
            for (int z = 0; z < 8; ++z) bias[x][y][z] = chosen(low[z], high[z], most);
        }
    }
}

void addAlongY(const CellSamples& s, int edge, float most, CellNumbers& bias) {
    float sums[9][8];
    float second[9][8];  // of one x
    for (int x = 0; x < edge; ++x) {
        for (int y = 0; y <= edge; ++y)
            for (int z = 0; z < 8; ++z)
                sums[y][z] = s[x][y][z] + s[x][y][z + 1] + (s[x + 1][y][z] + s[x + 1][y][z + 1]);
        for (int y = 1; y < edge; ++y)
            for (int z = 0; z < 8; ++z) second[y][z] = sums[y - 1][z] - 2 * sums[y][z] + sums[y + 1][z];
        for (int y = 0; y < edge; ++y) {
            const float(&low)[8] = second[y == 0 ? 1 : y];
            const float(&high)[8] = second[y == edge - 1 ? y : y + 1];
            for (int z = 0; z < 8; ++z) bias[x][y][z] += chosen(low[z], high[z], most);
        }
    }
}

void addAlongZ(const CellSamples& s, int edge, float most, CellNumbers& bias) {
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y) {
            float sums[9];
            for (int z = 0; z < 9; ++z) sums[z] = s[x][y][z] + s[x][y + 1][z] + (s[x + 1][y][z] + s[x + 1][y + 1][z]);
            float second[9];
            for (int z = 1; z < 8; ++z) second[z] = sums[z - 1] - 2 * sums[z] + sums[z + 1];
            second[0] = second[1];
            second[8] = second[7];
            for (int z = 0; z < 8; ++z) bias[x][y][z] += chosen(second[z], second[z + 1], most);
        }
}

}  // namespace

void interpolationBias(const CellSamples& samples, double voxel, CellNumbers& bias, int edge) {
    const float most = 4 * kMost * static_cast<float>(voxel);
    setAlongX(samples, edge, most, bias);
    addAlongY(samples, edge, most, bias);
    addAlongZ(samples, edge, most, bias);
}

}  // namespace stratum::report
