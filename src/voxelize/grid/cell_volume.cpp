#include "voxelize/grid/cell_volume.h"

#include <bit>

namespace stratum::voxelize {
namespace {

double insideLength(double low, double high) {
    if ((low < 0) == (high < 0)) return low < 0 ? 1 : 0;
    return low < 0 ? low / (low - high) : high / (high - low);
}

// Share of a cell that is inside: the field is linear along z, so exact on each of the four lines of a Gauss rule.
double insideShare(const LeafSamples& leaf, int x, int y, int z) {
    const auto& s = leaf.v;
    constexpr double kGauss[2] = {0.21132486540518713, 0.78867513459481287};
    double sum = 0;
    for (const double u : kGauss)
        for (const double v : kGauss) {
            const auto at = [&](int k) {
                const double a = s[x][y][k] + u * (static_cast<double>(s[x + 1][y][k]) - s[x][y][k]);
                const double b = s[x][y + 1][k] + u * (static_cast<double>(s[x + 1][y + 1][k]) - s[x][y + 1][k]);
                return a + v * (b - a);
            };
            sum += insideLength(at(z), at(z + 1));
        }
    return 0.25 * sum;
}

}  // namespace

double insideCells(const LeafSamples& leaf, int edge) {
    const auto& s = leaf.v;
    // One bit for each sample: full and empty cells are found eight at a time.
    std::uint32_t negative[LeafSamples::kEdge][LeafSamples::kEdge];
    for (int x = 0; x < LeafSamples::kEdge; ++x)
        for (int y = 0; y < LeafSamples::kEdge; ++y) {
            std::uint32_t bits = 0;
            for (int z = 0; z < LeafSamples::kEdge; ++z) bits |= (s[x][y][z] < 0 ? 1U : 0U) << z;
            negative[x][y] = bits;
        }
    double sum = 0;
    for (int x = 0; x < edge; ++x)
        for (int y = 0; y < edge; ++y) {
            const std::uint32_t all = negative[x][y] & negative[x][y + 1] & negative[x + 1][y] & negative[x + 1][y + 1];
            const std::uint32_t any = negative[x][y] | negative[x][y + 1] | negative[x + 1][y] | negative[x + 1][y + 1];
            const std::uint32_t solid = all & all >> 1 & 0xffU;
            sum += std::popcount(solid);
            for (std::uint32_t mixed = (any | any >> 1) & ~solid & 0xffU; mixed != 0; mixed &= mixed - 1)
                sum += insideShare(leaf, x, y, std::countr_zero(mixed));
        }
    return sum;
}

std::uint64_t scattered(std::uint64_t n) {
    n = (n + 1) * 0x9e3779b97f4a7c15U;
    n = (n ^ n >> 30) * 0xbf58476d1ce4e5b9U;
    n = (n ^ n >> 27) * 0x94d049bb133111ebU;
    return n ^ n >> 31;
}

}  // namespace stratum::voxelize
