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
// Depths end so much before a block, in cells: a ray begins in the empty space before it, as if it had come from there.
constexpr double kBefore = 0x1p-6;

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
    open_.fill(0);
}

void Beams::findDepths() {
    depths_.fill(kInfinity);
    const int slabs = grid_.size()[static_cast<std::size_t>(fan_.main)] / kMacro;
    // Slabs are counted along the way; those behind the eye are left out.
    const double at = fan_.eye[fan_.main] / kMacro;
    const int begin =
        static_cast<int>(std::clamp(std::floor(fan_.forth ? at : slabs - at), 0.0, static_cast<double>(slabs)));
    for (int slab = begin; slab < slabs && shrink(); ++slab) meetMacros(fan_.forth ? slab : slabs - 1 - slab);
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

template <typename Visit>
static void forEachMacro(const std::array<int, 3>& low, const std::array<int, 3>& high, const Visit& visit) {
    for (int x = low[0] / kMacro; x <= high[0] / kMacro; ++x)
        for (int y = low[1] / kMacro; y <= high[1] / kMacro; ++y)
            for (int z = low[2] / kMacro; z <= high[2] / kMacro; ++z) visit(x, y, z);
}

// A slab of macro cells.
void Beams::meetMacros(int slab) {
    Box box;
    if (!cover({fan_, slab * kMacro, (slab + 1) * kMacro}, box)) return;
    std::uint64_t any = 0;
    forEachMacro(box.low, box.high, [&](int x, int y, int z) { any |= grid_.macroCell(x, y, z).bricks; });
    for (int n = 0; n < kMacro / kBrick; ++n) {
        const int thin = fan_.forth ? n : kMacro / kBrick - 1 - n;
        const std::uint64_t among = any & kSlabMask[fan_.main][thin];
        const int from = slab * kMacro + thin * kBrick;
        if (among == 0) continue;
        const Layer bricks(fan_, from, from + kBrick);
        const bool behind = bricks.far <= 0;
        if (behind || !cover(bricks, box)) continue;
        for (int half = 0; half < 2; ++half) {  // blocks of a half have one depth
            const int part = fan_.forth ? half : 1 - half;
            const int block = from + part * kPart;
            const Layer parts(fan_, block, block + kPart);
            forEachMacro(box.low, box.high, [&](int x, int y, int z) {
                const MacroCell& macro = grid_.macroCell(x, y, z);
                if ((macro.bricks & among) != 0)
                    meetBricks(macro, {x * kMacro, y * kMacro, z * kMacro}, macro.bricks & among, part, bricks, parts);
            });
        }
    }
}

// One layer of blocks, of some bricks of a macro cell.
void Beams::meetBricks(const MacroCell& macro, const std::array<int, 3>& corner, std::uint64_t among, int half,
                       const Layer& bricks, const Layer& parts) {
    const double depth = parts.near - kBefore;
    for (; among != 0; among &= among - 1) {
        const int bit = std::countr_zero(among);
        const int x = bit >> 4;
        const int y = bit >> 2 & 3;
        const int z = bit & 3;
        const std::array<int, 3> brick = {corner[0] + x * kBrick, corner[1] + y * kBrick, corner[2] + z * kBrick};
        Rectangle beams;
        if (!project(brick, kBrick, bricks, beams) || !anyOpen(beams)) continue;
        const std::size_t index = BrickGrid::brickIndex(macro, x, y, z);
        for (int part = 0; part < 8; ++part) {
            const std::array<int, 3> at = {part >> 2, part >> 1 & 1, part & 1};
            if (at[static_cast<std::size_t>(fan_.main)] != half ||
                grid_.surface(index, static_cast<std::size_t>(part)) == 0)
                continue;
            if (project({brick[0] + at[0] * kPart, brick[1] + at[1] * kPart, brick[2] + at[2] * kPart}, kPart, parts,
                        beams))
                meet(beams, depth);
        }
    }
}

// The beams that a cube of cells is in; false if there is none.
bool Beams::project(const std::array<int, 3>& corner, int edge, const Layer& layer, Rectangle& beams) const {
    for (int k = 0; k < 2; ++k) {
        const int axis = (fan_.main + 1 + k) % 3;
        const double least = corner[static_cast<std::size_t>(axis)] - fan_.eye[axis] - layer.margin;
        const double most = least + edge + 2 * layer.margin;
        const double low = least * (least < 0 ? layer.per_near : layer.per_far);
        const double high = most * (most > 0 ? layer.per_near : layer.per_far);
        if (!(high >= fan_.low[k] && low <= fan_.high[k])) return false;
        // All beams are in one row if there is one slope: the scale is 0, and infinite slopes must not meet it.
        const double first = low > fan_.low[k] ? (low - fan_.low[k]) * scale_[k] : 0;
        const double last = high < fan_.high[k] ? (high - fan_.low[k]) * scale_[k] : count_[k] - 1;
        beams.first[k] = static_cast<int>(first);
        beams.last[k] = std::min(static_cast<int>(last), count_[k] - 1);
    }
    return true;
}

bool Beams::anyOpen(const Rectangle& beams) const {
    std::uint32_t open = 0;
    for (int row = beams.first[1]; row <= beams.last[1]; ++row) open |= open_[static_cast<std::size_t>(row)];
    return (open & beams.columns()) != 0;
}

void Beams::meet(const Rectangle& beams, double depth) {
    const std::uint32_t columns = beams.columns();
    for (auto row = static_cast<std::size_t>(beams.first[1]); row <= static_cast<std::size_t>(beams.last[1]); ++row) {
        for (std::uint32_t met = open_[row] & columns; met != 0; met &= met - 1)
            depths_[row * kMostSide + static_cast<std::size_t>(std::countr_zero(met))] = depth;
        open_[row] &= ~columns;
    }
}

}  // namespace stratum::march
