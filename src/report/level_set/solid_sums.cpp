#include "report/level_set/solid_sums.h"

#include "base/parallel_for.h"
#include "report/level_set/cell_surface.h"
#include "report/level_set/interpolation_bias.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/leaf/leaf_kernels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>

namespace stratum::report {
namespace {

// Parts with sums of their own, added in order; so many for any number of threads.
constexpr std::size_t kParts = 192;

// Of the set bits of a byte: how many, and the sums of their numbers and of the squares.
struct Bits {
    std::uint8_t count, sum, squares;
};
constexpr std::array<Bits, 256> kBits = [] {
    std::array<Bits, 256> table{};
    for (unsigned byte = 0; byte < 256; ++byte)
        for (unsigned n = 0; n < 8; ++n)
            if ((byte >> n & 1U) != 0) {
                ++table[byte].count;
                table[byte].sum = static_cast<std::uint8_t>(table[byte].sum + n);
                table[byte].squares = static_cast<std::uint8_t>(table[byte].squares + n * n);
            }
    return table;
}();

// Four floats in a register, by the compiler: without branches, which are hard to foretell here.
using Four = float __attribute__((vector_size(16)));

// Volume and moments of a column of eight cells, about its corner.
struct ColumnSums {
    double volume = 0, x = 0, y = 0, z = 0, zz = 0, xz = 0, yz = 0;

    void addWhole(const Bits& solid) {
        const double n = solid.count;
        const double along = solid.sum + 0.5 * n;  // the integral of z
        volume += n;
        x += 0.5 * n;
        y += 0.5 * n;
        z += along;
        zz += solid.squares + solid.sum + n / 3;
        xz += 0.5 * along;
        yz += 0.5 * along;
    }
    // `part`: volume and first moments of what is solid of each cell, summed over the cells; `part_k` and `part_kk`
    // weighted by the cell's number and by its square. Second moments within a cell are those of a whole one of that
    // volume: they matter by the square of a voxel over the size of the print.
    void addParts(const Four& part, const Four& part_k, float part_kk) {
        const auto w = static_cast<double>(part[0]);
        volume += w;
        x += static_cast<double>(part[1]);
        y += static_cast<double>(part[2]);
        z += static_cast<double>(part_k[0]) + static_cast<double>(part[3]);
        zz += static_cast<double>(part_kk) + 2 * static_cast<double>(part_k[3]) + w / 3;
        xz += static_cast<double>(part_k[1]) + 0.25 * w;
        yz += static_cast<double>(part_k[2]) + 0.25 * w;
    }
    // About a place from which the corner is (ox, oy, oz).
    void addTo(SolidSums& sums, double ox, double oy, double oz) const {
        sums.volume += volume;
        sums.first[0] += x + ox * volume;
        sums.first[1] += y + oy * volume;
        sums.first[2] += z + oz * volume;
        sums.second[0] += ox * (ox * volume + 2 * x) + volume / 3;
        sums.second[1] += oy * (oy * volume + 2 * y) + volume / 3;
        sums.second[2] += zz + oz * (oz * volume + 2 * z);
        sums.second[3] += 0.25 * volume + ox * y + oy * x + ox * oy * volume;
        sums.second[4] += xz + ox * z + oz * x + ox * oz * volume;
        sums.second[5] += yz + oy * z + oz * y + oy * oz * volume;
    }
};

// Volume and first moments about its corner of what is below `level` of a cell, by four lines along z through a cell,
// on the places of a Gauss rule: the field is linear on each.
Four partOf(const CellSamples& s, int x, int y, int z, float level) {
    constexpr float kLow = 0.21132486540518713F;
    constexpr float kHigh = 0.78867513459481287F;
    constexpr Four kU = {kLow, kLow, kHigh, kHigh};
    constexpr Four kV = {kLow, kHigh, kLow, kHigh};
    const auto on = [&](int k) {
        const float a = s[x][y][k];
        const float c = s[x][y + 1][k];
        const Four low = a + kU * (s[x + 1][y][k] - a);
        const Four high = c + kU * (s[x + 1][y + 1][k] - c);
        return low + kV * (high - low) - level;
    };
    const Four low = on(z);
    const Four high = on(z + 1);
    // Where both ends are inside or both outside, the quotient is not used.
    const Four zero = (low < 0) != (high < 0) ? low / (low - high) : Four{1, 1, 1, 1};
    const Four from = low < 0 ? Four{} : high < 0 ? zero : Four{1, 1, 1, 1};
    const Four to = low < 0 ? zero : Four{1, 1, 1, 1};
    const Four length = to - from;
    const Four along = 0.5F * (to * to - from * from);
    const float left = length[0] + length[1];
    const float right = length[2] + length[3];
    const float front = length[0] + length[2];
    const float back = length[1] + length[3];
    return Four{0.25F * (left + right), 0.25F * (kLow * left + kHigh * right), 0.25F * (kLow * front + kHigh * back),
                0.25F * (along[0] + along[1] + along[2] + along[3])};
}

// The kinds of air at the samples of a leaf's cells: rows of bits along z, as the signs.
struct AirRows {
    std::uint32_t outside[9][9] = {}, open[9][9] = {};
    bool any_outside = false, any_open = false, any_closed = false;

    bool hasPores() const { return any_open || any_closed; }
    bool oneKind() const { return int{any_outside} + int{any_open} + int{any_closed} == 1; }
};

AirRows airOf(const LeafMap::CellPlaces& places, const Outside& outside, const std::uint32_t (&negative)[9][9]) {
    AirRows rows;
    for (int corner = 0; corner < 8; ++corner) {
        const int dx = corner & 1;
        const int dy = corner >> 1 & 1;
        const int dz = corner >> 2;
        const LeafMap::Place& place = places[static_cast<std::size_t>(corner)];
        const Air all = place.leaf ? Air::closed : outside.ofGap(place.index);
        for (int x = 0; x < (dx != 0 ? 1 : 8); ++x)
            for (int y = 0; y < (dy != 0 ? 1 : 8); ++y) {
                std::uint32_t shown = all == Air::outside ? 0xffU : 0;
                std::uint32_t open = all == Air::open ? 0xffU : 0;
                if (place.leaf) {
                    shown = static_cast<std::uint32_t>(outside.shown(place.index).word[static_cast<std::size_t>(x)] >>
                                                       (8 * y)) &
                            0xffU;
                    open = static_cast<std::uint32_t>(outside.any(place.index).word[static_cast<std::size_t>(x)] >>
                                                      (8 * y)) &
                           0xffU & ~shown;
                }
                if (dz != 0) shown = (shown & 1U) << 8, open = (open & 1U) << 8;
                rows.outside[x + 8 * dx][y + 8 * dy] |= shown;
                rows.open[x + 8 * dx][y + 8 * dy] |= open;
            }
    }
    for (int x = 0; x < 9; ++x)
        for (int y = 0; y < 9; ++y) {
            const std::uint32_t air = ~negative[x][y] & 0x1ffU;
            rows.outside[x][y] &= air;
            rows.open[x][y] &= air;
            rows.any_outside = rows.any_outside || rows.outside[x][y] != 0;
            rows.any_open = rows.any_open || rows.open[x][y] != 0;
            rows.any_closed = rows.any_closed || (air & ~rows.outside[x][y] & ~rows.open[x][y]) != 0;
        }
    return rows;
}

// Shares of a cell's air by the kinds of its corners.
struct Shares {
    double outside, open, closed;
};
// The bits of the eight corners of a cell.
unsigned cornersOf(const std::uint32_t (&rows)[9][9], int x, int y, int z) {
    return (rows[x][y] >> z & 3U) | (rows[x][y + 1] >> z & 3U) << 2 | (rows[x + 1][y] >> z & 3U) << 4 |
           (rows[x + 1][y + 1] >> z & 3U) << 6;
}
Shares sharesOf(const AirRows& air, const std::uint32_t (&negative)[9][9], int x, int y, int z) {
    // Most leaves have one kind alone.
    if (air.oneKind()) return {air.any_outside ? 1.0 : 0.0, air.any_open ? 1.0 : 0.0, air.any_closed ? 1.0 : 0.0};
    constexpr double kInverse[9] = {0, 1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};
    const int outside = kBits[cornersOf(air.outside, x, y, z)].count;
    const int open = kBits[cornersOf(air.open, x, y, z)].count;
    const int all = 8 - kBits[cornersOf(negative, x, y, z)].count;
    const double each = kInverse[all];
    return {outside * each, open * each, (all - outside - open) * each};
}

class Sweep {
public:
    Sweep(const LeafMap& map, float background, double voxel, const Outside* outside)
        : map_(map), background_(background), voxel_(voxel), outside_(outside) {}

    // Adds the leaf's cells to the sums of a part.
    void addLeaf(std::size_t n, bool with_area, SolidSums& sums) {
        const LeafMap::CellPlaces places = map_.cellPlaces(n);
        map_.gather(places, s_, background_);
        const bool mixed = findSigns(map_.leaf(n).buffer().data());
        if (mixed) interpolationBias(s_, voxel_, bias_);
        const openvdb::Coord origin = map_.leaf(n).origin();
        RowSums* rows = sums.rows.data() + (origin.z() - sums.first_row);
        air_ = nullptr;
        AirRows air;
        if (outside_ != nullptr && (mixed || negative_[0][0] == 0)) {
            air = airOf(places, *outside_, negative_);
            air_ = &air;
        }
        for (int x = 0; x < 8; ++x)
            for (int y = 0; y < 8; ++y) {
                ColumnSums column;
                addColumn(x, y, with_area, rows, column, sums);
                if (column.volume > 0) column.addTo(sums, origin.x() + x, origin.y() + y, origin.z());
            }
    }

private:
    // Sets negative_; returns whether there are both signs. `own`: the leaf's samples, which s_ has, too.
    bool findSigns(const float* own) {
        std::uint64_t air[8];  // eight samples along z a byte
        voxelize::maskFrom(own, 0.0F, air);
        std::uint32_t all = 0x1ffU;
        std::uint32_t any = 0;
        for (int x = 0; x < 9; ++x)
            for (int y = 0; y < 9; ++y) {
                std::uint32_t bits = (s_[x][y][8] < 0 ? 1U : 0U) << 8;
                if (x < 8 && y < 8)
                    bits |= ~static_cast<std::uint32_t>(air[x] >> (8 * y)) & 0xffU;
                else
                    for (int z = 0; z < 8; ++z) bits |= (s_[x][y][z] < 0 ? 1U : 0U) << z;
                negative_[x][y] = bits;
                all &= bits;
                any |= bits;
            }
        return any != 0 && all != 0x1ffU;
    }

    void addColumn(int x, int y, bool with_area, RowSums* rows, ColumnSums& column, SolidSums& sums) {
        const auto& n = negative_;
        const std::uint32_t all = n[x][y] & n[x][y + 1] & n[x + 1][y] & n[x + 1][y + 1];
        const std::uint32_t any = n[x][y] | n[x][y + 1] | n[x + 1][y] | n[x + 1][y + 1];
        const std::uint32_t solid = all & all >> 1 & 0xffU;
        const std::uint32_t mixed = (any | any >> 1) & ~solid & 0xffU;
        if (solid != 0) {
            column.addWhole(kBits[solid]);
            for (std::uint32_t bits = solid; bits != 0; bits &= bits - 1) rows[std::countr_zero(bits)].solid += 1;
        }
        if (mixed != 0) addMixed(x, y, mixed, with_area, rows, column, sums);
        if (air_ == nullptr || !air_->hasPores()) return;
        for (std::uint32_t bits = ~(solid | mixed) & 0xffU; bits != 0; bits &= bits - 1)
            addAir(x, y, std::countr_zero(bits), 1, rows[std::countr_zero(bits)]);
    }

    void addMixed(int x, int y, std::uint32_t mixed, bool with_area, RowSums* rows, ColumnSums& column,
                  SolidSums& sums) {
        Four sum{};
        Four sum_k{};
        float sum_kk = 0;
        for (; mixed != 0; mixed &= mixed - 1) {
            const int z = std::countr_zero(mixed);
            const auto k = static_cast<float>(z);
            const Four part = partOf(s_, x, y, z, bias_[x][y][z]);
            sum += part;
            sum_k += k * part;
            sum_kk += k * k * part[0];
            const auto share = static_cast<double>(part[0]);
            rows[z].solid += share;
            const bool pores = air_ != nullptr && air_->hasPores();
            if (!pores && !with_area) continue;
            const Shares shares = pores ? sharesOf(*air_, negative_, x, y, z) : Shares{1, 0, 0};
            rows[z].open += (1 - share) * shares.open;
            rows[z].closed += (1 - share) * shares.closed;
            if (with_area) addArea(x, y, z, shares.outside, sums);
        }
        column.addParts(sum, sum_k, sum_kk);
    }

    void addAir(int x, int y, int z, double volume, RowSums& row) const {
        const Shares shares = sharesOf(*air_, negative_, x, y, z);
        row.open += volume * shares.open;
        row.closed += volume * shares.closed;
    }

    void addArea(int x, int y, int z, double outer, SolidSums& sums) const {
        float corners[8];
        for (int n = 0; n < 8; ++n) corners[n] = s_[x + (n & 1)][y + (n >> 1 & 1)][z + (n >> 2)];
        const double area = cellSurface(corners);
        sums.outer_area += area * outer;
        sums.inner_area += area * (1 - outer);
    }

    const LeafMap& map_;
    const float background_;
    const double voxel_;
    const Outside* const outside_;
    const AirRows* air_ = nullptr;
    CellSamples s_;
    CellNumbers bias_;
    std::uint32_t negative_[9][9];
};

// The gaps of a column that are solid, or pores.
void addGaps(const LeafMap& map, std::size_t c, const Outside* outside, SolidSums& sums) {
    const voxelize::LeafPositions& positions = map.positions();
    for (std::size_t number = 1; number < positions.intervalsOf(c).size(); ++number) {
        const voxelize::LeafPositions::Range range = positions.gapRange(c, number);
        const std::size_t gap = positions.firstGap(c) + number;
        const bool solid = map.gapInside(gap);
        const Air air = outside == nullptr ? Air::outside : outside->ofGap(gap);
        if (!solid && air == Air::outside) continue;
        for (int k = range.low * 8; k < range.high * 8; ++k) {
            RowSums& row = sums.rows[static_cast<std::size_t>(k - sums.first_row)];
            (solid ? row.solid : air == Air::open ? row.open : row.closed) += 64;
        }
        if (!solid) continue;
        ColumnSums whole;
        whole.addWhole(kBits[0xff]);
        for (int k = range.low; k < range.high; ++k)
            for (int x = 0; x < 8; ++x)
                for (int y = 0; y < 8; ++y)
                    whole.addTo(sums, positions.columnI(c) * 8 + x, positions.columnJ(c) * 8 + y, k * 8);
    }
}

void add(const SolidSums& part, SolidSums& sums) {
    for (std::size_t r = 0; r < part.rows.size(); ++r) {
        sums.rows[r].solid += part.rows[r].solid;
        sums.rows[r].open += part.rows[r].open;
        sums.rows[r].closed += part.rows[r].closed;
    }
    sums.volume += part.volume;
    for (int n = 0; n < 3; ++n) sums.first[n] += part.first[n];
    for (int n = 0; n < 6; ++n) sums.second[n] += part.second[n];
    sums.outer_area += part.outer_area;
    sums.inner_area += part.inner_area;
    sums.area_leaves += part.area_leaves;
}

}  // namespace

SolidSums sumSolid(const LeafMap& map, float background, double voxel, const Outside* outside) {
    SolidSums sums;
    const std::size_t leaves = map.leafCount();
    if (leaves == 0) return sums;
    int low = std::numeric_limits<int>::max();
    int high = std::numeric_limits<int>::min();
    for (std::size_t n = 0; n < leaves; ++n) {
        low = std::min(low, map.leafK(n));
        high = std::max(high, map.leafK(n));
    }
    sums.first_row = low * 8;
    sums.rows.resize(static_cast<std::size_t>(high - low + 1) * 8);
    std::vector<SolidSums> parts(std::min(kParts, map.positions().columnCount()));
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p) {
            SolidSums& part = parts[p];
            part.first_row = sums.first_row;
            part.rows.resize(sums.rows.size());
            Sweep sweep(map, background, voxel, outside);
            // By leaves, for their number says how long it takes; and by the columns that begin there.
            const std::size_t first = leaves * p / parts.size();
            const std::size_t last = leaves * (p + 1) / parts.size();
            for (std::size_t n = first; n < last; ++n) {
                const bool with_area = leaves <= kAreaSample || voxelize::scattered(n) % leaves < kAreaSample;
                part.area_leaves += with_area ? 1 : 0;
                sweep.addLeaf(n, with_area, part);
                if (n == map.firstLeaf(map.columnOf(n))) addGaps(map, map.columnOf(n), outside, part);
            }
        }
    });
    for (const SolidSums& part : parts) add(part, sums);
    if (sums.area_leaves > 0) {
        const double scale = static_cast<double>(leaves) / static_cast<double>(sums.area_leaves);
        sums.outer_area *= scale;
        sums.inner_area *= scale;
    }
    return sums;
}

}  // namespace stratum::report
