#include "march/brick/beam.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace stratum::march {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRaysPerBeam = 4;
constexpr int kBrick = BrickGrid::kBrickEdge;
constexpr int kMacro = BrickGrid::kMacroEdge;
constexpr int kPart = kBrick / 2;  // cells of a block

// The bricks of a macro cell that lie in one of its four slabs across an axis.
constexpr std::uint64_t slabMask(int axis, int slab) {
    std::uint64_t mask = 0;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
            const int x = axis == 0 ? slab : a;
            const int y = axis == 1 ? slab : (axis == 0 ? a : b);
            const int z = axis == 2 ? slab : b;
            mask |= std::uint64_t{1} << Mask64::bit(x, y, z);
        }
    return mask;
}
constexpr std::uint64_t kSlabMask[3][4] = {{slabMask(0, 0), slabMask(0, 1), slabMask(0, 2), slabMask(0, 3)},
                                           {slabMask(1, 0), slabMask(1, 1), slabMask(1, 2), slabMask(1, 3)},
                                           {slabMask(2, 0), slabMask(2, 1), slabMask(2, 2), slabMask(2, 3)}};

// Against the rounding of rays' positions: a few 2^-52 of their way and of the grid's size, at most 2^24 cells.
double marginAt(double depth) { return 0x1p-20 + depth * 0x1p-44; }

}  // namespace

Beams::Layer::Layer(const RayFan& fan, int from_cell, int to_cell) : from(from_cell), to(to_cell) {
    const double eye = fan.eye[fan.main];
    near = std::max(fan.forth ? from - eye : eye - to, 0.0);
    far = fan.forth ? to - eye : eye - from;
    per_near = near > 0 ? 1 / near : kInfinity;
    per_far = 1 / far;
    margin = marginAt(far);
}

void Beams::begin(const RayFan& fan, std::size_t rays) {
    fan_ = fan;
    const double width = fan.high[0] - fan.low[0];
    const double height = fan.high[1] - fan.low[1];
    const double beams = static_cast<double>(rays) / kRaysPerBeam;
    const double columns = width > 0 ? (height > 0 ? std::sqrt(beams * width / height) : beams) : 1;
    count_[0] = static_cast<int>(std::clamp(columns, 1.0, double{kMostSide}));
    count_[1] = static_cast<int>(std::clamp(height > 0 ? beams / count_[0] : 1, 1.0, double{kMostSide}));
    // A little less, so that the greatest slope is in the last beam.
    scale_[0] = width > 0 ? count_[0] * (1 - 1e-9) / width : 0;
    scale_[1] = height > 0 ? count_[1] * (1 - 1e-9) / height : 0;
    has_rays_.fill(0);
}

void Beams::findPlanes() {
    planes_.fill(kInfinity);
    openAll();
    const int slabs = grid_.size()[static_cast<std::size_t>(fan_.main)] / kMacro;
    // Slabs are counted along the way; those behind the eye are left out.
    const double at = fan_.eye[fan_.main] / kMacro;
    const int begin =
        static_cast<int>(std::clamp(std::floor(fan_.forth ? at : slabs - at), 0.0, static_cast<double>(slabs)));
    for (int slab = begin; slab < slabs && shrink(); ++slab) meetMacros(fan_.forth ? slab : slabs - 1 - slab);
}

// Those with rays.
void Beams::openAll() {
    for (std::size_t row = 0; row < kMostSide; ++row) {
        open_[row] = 0;
        for (std::size_t column = 0; column < kMostSide; ++column)
            open_[row] |= std::uint32_t{has_rays_[row * kMostSide + column]} << column;
    }
}

// The slopes of the beams that are open; false if there is none.
bool Beams::shrink() {
    std::uint32_t columns = 0;
    int first = count_[1];
    int last = -1;
    for (int row = 0; row < count_[1]; ++row) {
        if (open_[static_cast<std::size_t>(row)] == 0) continue;
        columns |= open_[static_cast<std::size_t>(row)];
        first = std::min(first, row);
        last = row;
    }
    if (columns == 0) return false;
    const int firsts[2] = {std::countr_zero(columns), first};
    const int lasts[2] = {31 - std::countl_zero(columns), last};
    for (int k = 0; k < 2; ++k) {
        low_[k] = scale_[k] > 0 ? fan_.low[k] + firsts[k] / scale_[k] : fan_.low[k];
        high_[k] = scale_[k] > 0 ? fan_.low[k] + (lasts[k] + 1) / scale_[k] : fan_.high[k];
    }
    return true;
}

// The cells that open beams have in [from, to) of the main axis; false if they have none in the grid.
bool Beams::cover(const Layer& layer, Box& box) const {
    const auto main = static_cast<std::size_t>(fan_.main);
    box.low[main] = layer.from;
    box.high[main] = layer.to - 1;
    for (int k = 0; k < 2; ++k) {
        const int axis = (fan_.main + 1 + k) % 3;
        const auto a = static_cast<std::size_t>(axis);
        const double least = fan_.eye[axis] + std::min(low_[k] * layer.near, low_[k] * layer.far) - layer.margin;
        const double most = fan_.eye[axis] + std::max(high_[k] * layer.near, high_[k] * layer.far) + layer.margin;
        const double size = grid_.size()[a];
        if (!(most >= 0 && least < size)) return false;
        box.low[a] = static_cast<int>(std::max(least, 0.0));
        box.high[a] = static_cast<int>(std::min(most, size - 1.0));
    }
    return true;
}

// A slab of macro cells.
void Beams::meetMacros(int slab) {
    Box box;
    if (!cover({fan_, slab * kMacro, (slab + 1) * kMacro}, box)) return;
    found_.clear();
    std::uint64_t any = 0;
    for (int x = box.low[0] / kMacro; x <= box.high[0] / kMacro; ++x)
        for (int y = box.low[1] / kMacro; y <= box.high[1] / kMacro; ++y)
            for (int z = box.low[2] / kMacro; z <= box.high[2] / kMacro; ++z) {
                const MacroCell& macro = grid_.macroCell(x, y, z);
                if (macro.bricks == 0) continue;
                any |= macro.bricks;
                found_.push_back({&macro, {x * kMacro, y * kMacro, z * kMacro}});
            }
    for (int n = 0; n < kMacro / kBrick; ++n) {
        const int thin = fan_.forth ? n : kMacro / kBrick - 1 - n;
        const std::uint64_t among = any & kSlabMask[fan_.main][thin];
        if (among == 0) continue;
        for (int m = 0; m < 2; ++m) {
            const int half = fan_.forth ? m : 1 - m;
            const int from = slab * kMacro + thin * kBrick + half * kPart;
            meetBlocks({fan_, from, from + kPart}, among, half);
        }
    }
}

// A layer of blocks, of these bricks.
void Beams::meetBlocks(const Layer& layer, std::uint64_t among, int half) {
    const bool behind = layer.far <= 0;
    Box box;
    if (behind || !cover(layer, box)) return;
    project(layer, box);
    const double plane = fan_.forth ? layer.from : -layer.to;
    const auto within = [&](const std::array<int, 3>& corner) {
        bool in = true;
        for (std::size_t axis = 0; axis < 3; ++axis)
            in &= corner[axis] <= box.high[axis] && corner[axis] + kMacro > box.low[axis];
        return in;
    };
    for (const Found& found : found_)
        if ((found.macro->bricks & among) != 0 && within(found.corner))
            meetBricks(*found.macro, found.corner, found.macro->bricks & among, half, plane);
}

// All blocks of the macro cells in the box.
void Beams::project(const Layer& layer, const Box& box) {
    for (int k = 0; k < 2; ++k) {
        const auto axis = static_cast<std::size_t>((fan_.main + 1 + k) % 3);
        const int begin = box.low[axis] / kMacro * kMacro;
        const int end = box.high[axis] / kMacro * kMacro + kMacro;
        begin_[k] = begin / kPart;
        project(k, layer, begin, end, k == 0 ? column_range_ : rows_);
    }
    columns_.resize(column_range_.first.size());
    for (std::size_t n = 0; n < columns_.size(); ++n) {
        const int first = column_range_.first[n];
        const int last = column_range_.last[n];
        columns_[n] = last < first ? 0 : ~0U >> (31 - last) & ~0U << first;
    }
}

// Blocks between these cells along an axis across. Without branches, so that compilers make vectors of it.
void Beams::project(int k, const Layer& layer, int begin, int end, Ranges& ranges) const {
    const int blocks = (end - begin) / kPart;
    ranges.first.resize(static_cast<std::size_t>(blocks));
    ranges.last.resize(static_cast<std::size_t>(blocks));
    int* const first = ranges.first.data();
    int* const last = ranges.last.data();
    const double start = begin - fan_.eye[(fan_.main + 1 + k) % 3] - layer.margin;
    const double edge = kPart + 2 * layer.margin;
    const double near = layer.per_near;
    const double far = layer.per_far;
    const double least_slope = fan_.low[k];
    const double most_slope = fan_.high[k];
    const double scale = scale_[k];
    const double count = count_[k];
    for (int n = 0; n < blocks; ++n) {
        const double least = start + n * kPart;
        const double most = least + edge;
        const double low = least * (least < 0 ? near : far);
        const double high = most * (most > 0 ? near : far);
        // Of infinite slopes, and with a scale of 0, these are no numbers: then all beams are met.
        const double from = (low - least_slope) * scale;
        const double to = (high - least_slope) * scale;
        const double clamped_from = from > 0 ? from : 0;
        const double clamped_to = to < count - 1 ? to : count - 1;
        first[n] = static_cast<int>(low <= most_slope ? clamped_from : count);
        last[n] = static_cast<int>(high >= least_slope ? clamped_to : -1);
    }
}

// One layer of blocks, of some bricks of a macro cell.
void Beams::meetBricks(const MacroCell& macro, const std::array<int, 3>& corner, std::uint64_t among, int half,
                       double plane) {
    const auto main = static_cast<std::size_t>(fan_.main);
    const std::size_t across[2] = {(main + 1) % 3, (main + 2) % 3};
    for (; among != 0; among &= among - 1) {
        const int bit = std::countr_zero(among);
        const std::array<int, 3> brick = {bit >> 4, bit >> 2 & 3, bit & 3};
        const auto place = [&](int k) {
            return static_cast<std::size_t>((corner[across[k]] + brick[across[k]] * kBrick) / kPart - begin_[k]);
        };
        const std::uint32_t* const columns = &columns_[place(0)];
        const int* const first = &rows_.first[place(1)];
        const int* const last = &rows_.last[place(1)];
        if (!anyOpen(first[0], last[1], columns[0] | columns[1])) continue;
        const std::size_t index = BrickGrid::brickIndex(macro, brick[0], brick[1], brick[2]);
        for (std::size_t a = 0; a < 2; ++a)
            for (std::size_t b = 0; b < 2; ++b) {
                std::array<std::size_t, 3> at{};
                at[main] = static_cast<std::size_t>(half);
                at[across[0]] = a;
                at[across[1]] = b;
                if (grid_.surface(index, at[0] << 2 | at[1] << 1 | at[2]) != 0)
                    meet(first[b], last[b], columns[a], plane);
            }
    }
}

bool Beams::anyOpen(int first_row, int last_row, std::uint32_t columns) const {
    std::uint32_t open = 0;
    for (int row = first_row; row <= last_row; ++row) open |= open_[static_cast<std::size_t>(row)];
    return (open & columns) != 0;
}

void Beams::meet(int first_row, int last_row, std::uint32_t columns, double plane) {
    for (int n = first_row; n <= last_row; ++n) {
        const auto row = static_cast<std::size_t>(n);
        for (std::uint32_t met = open_[row] & columns; met != 0; met &= met - 1)
            planes_[row * kMostSide + static_cast<std::size_t>(std::countr_zero(met))] = plane;
        open_[row] &= ~columns;
    }
}

}  // namespace stratum::march
