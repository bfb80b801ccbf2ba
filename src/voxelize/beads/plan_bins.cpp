#include "voxelize/beads/plan_bins.h"

#include "base/error.h"
#include "base/human_text.h"
#include "base/parallel_for.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/footprint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace stratum::voxelize {
namespace {

// Beads in parts of equal number. A part counts and later fills its own entries, so the ranks of a column ascend for
// any number of parts.
constexpr std::size_t kMostParts = 16;
constexpr std::size_t kFewestBeadsAPart = 4096;
// The lists take at most one part in so many of the free memory; what is made with their help needs the rest.
constexpr double kListsOfMemory = 4;

// Ranks in parts of equal number, and what is known of the entries before anything is allocated: an upper bound by
// arithmetic, and the rectangle of columns.
struct Parts {
    std::size_t count = 1;
    double bound = 0;
    ColumnRange columns;
};

// At most so many entries of bins has a bead that reaches this far: see Footprints::limit().
double mostColumns(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double limit, const Lattice& lattice) {
    const double edge = lattice.voxel_size * kLeafDim;
    const double across = 2 * limit / edge + 1;
    const double dx = bead.x1 - bead.x0;
    const double dy = bead.y1 - bead.y0;
    double length = std::sqrt(dx * dx + dy * dy);
    if (bead.arc >= 0) length = gcode::PlanPath(toolpath, bead).length();
    return (length / edge + across) * across;
}

Parts boundEntries(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   const Footprints& footprints) {
    const std::size_t beads = stack.beads.size();
    Parts parts;
    // A power of two: parts are joined by twos where they are too many.
    parts.count = std::bit_floor(std::clamp<std::size_t>(beads / kFewestBeadsAPart, 1, kMostParts));
    std::vector<double> bounds(parts.count, 0.0);
    std::vector<ColumnRange> ranges(parts.count);
    parallelFor(parts.count, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p != end; ++p)
            for (std::size_t rank = beads * p / parts.count; rank != beads * (p + 1) / parts.count; ++rank) {
                const gcode::Bead& bead = toolpath.beads[stack.beads[rank]];
                const double limit = footprints.limit(bead);
                bounds[p] += mostColumns(toolpath, bead, limit, lattice);
                ranges[p].include(footprints.range(bead, limit));
            }
    });
    for (std::size_t p = 0; p < parts.count; ++p) {
        parts.bound += bounds[p];
        parts.columns.include(ranges[p]);
    }
    return parts;
}

using Block = PlanBins::Block;
constexpr int kBlockEdge = PlanBins::kBlockColumns;

// The parts of a row of columns [i0, i1] by block: visit(x, first, last), the latter within the block.
template <typename Visit>
void forEachBlockOfRow(int i0, int i1, const Visit& visit) {
    static_assert(kBlockEdge == 16);
    while (i0 <= i1) {
        const int last = std::min(i1, i0 | (kBlockEdge - 1));
        visit(i0 >> 4, i0 & (kBlockEdge - 1), last & (kBlockEdge - 1));
        i0 = last + 1;
    }
}

// The block before is mostly the next one, too.
struct alignas(64) BlockCursor {
    int x = 0, y = 0;
    std::uint32_t known = PlanIndex::kNone;

    template <typename Find>
    std::uint32_t number(int at_x, int at_y, const Find& find) {
        if (known == PlanIndex::kNone || at_x != x || at_y != y) {
            known = find(at_x, at_y);
            x = at_x;
            y = at_y;
        }
        return known;
    }
};

// How many beads of a part reach each column, by block.
struct Counts {
    using OfBlock = std::array<std::uint32_t, std::size_t{kBlockEdge} * kBlockEdge>;  // row by row
    PlanIndex index;
    std::vector<OfBlock> blocks;

    // Those of row j within a block.
    std::uint32_t* row(int x, int j) {
        const std::uint32_t n = at.number(x, j >> 4, [this](int i, int k) { return index.add(i, k); });
        if (n == blocks.size()) blocks.emplace_back();
        return blocks[n].data() + std::ptrdiff_t{j & (kBlockEdge - 1)} * kBlockEdge;
    }

    BlockCursor at;
};

// Blocks in the order of a .vdb file, with the columns that beads of any part reach.
std::vector<Block> blocksOf(const std::vector<Counts>& parts) {
    PlanIndex index;
    std::vector<Block> blocks;
    for (const Counts& part : parts)
        for (std::size_t n = 0; n < part.blocks.size(); ++n) {
            const auto [x, y] = part.index.squares()[n];
            const std::uint32_t at = index.add(x, y);
            if (at == blocks.size()) blocks.push_back({.x = x, .y = y});
            for (std::size_t c = 0; c < part.blocks[n].size(); ++c)
                if (part.blocks[n][c] != 0)
                    blocks[at].rows[c / kBlockEdge] |= static_cast<std::uint16_t>(1U << c % kBlockEdge);
        }
    constexpr int kUpperBits = 5;  // of OpenVDB's upper nodes
    const auto order = [](const Block& block) {
        return std::tuple(block.x >> kUpperBits, block.y >> kUpperBits, block.x, block.y);
    };
    std::sort(blocks.begin(), blocks.end(), [&](const Block& a, const Block& b) { return order(a) < order(b); });
    std::size_t columns = 0;
    for (Block& block : blocks) {
        block.first = columns;
        for (std::size_t row = 0; row < block.rows.size(); ++row) {
            block.before[row] = static_cast<std::uint16_t>(columns - block.first);
            columns += static_cast<std::size_t>(std::popcount(block.rows[row]));
        }
        block.last = columns;
    }
    return blocks;
}

// The counts by part, of which some are joined so that there are so many, and column.
std::vector<std::uint32_t> byColumn(const std::vector<Counts>& counts, std::size_t parts,
                                    const std::vector<Block>& blocks, const PlanIndex& index) {
    const std::size_t columns = blocks.back().last;
    std::vector<std::uint32_t> sums(parts * columns, 0);
    const std::size_t together = counts.size() / parts;
    parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin * together; p != end * together; ++p)
            for (std::size_t n = 0; n < counts[p].blocks.size(); ++n) {
                const auto [x, y] = counts[p].index.squares()[n];
                const Block& block = blocks[index.find(x, y)];
                std::uint32_t* column = sums.data() + p / together * columns + block.first;
                for (std::size_t c = 0; c < counts[p].blocks[n].size(); ++c)
                    if ((block.rows[c / kBlockEdge] >> c % kBlockEdge & 1) != 0) *column++ += counts[p].blocks[n][c];
            }
    });
    return sums;
}

void refuseIfTooLarge(double bytes, std::size_t free_memory) {
    const double limit = static_cast<double>(free_memory) / kListsOfMemory;
    if (bytes <= limit) return;
    // Of half the voxel they are four times as many at most.
    throw UsageError(fmt::format(
        "the lists of the beads near each voxel take about {}, which is more than a quarter of the {} that are "
        "free; "
        "choose voxels about {:.2g} times as large (--voxel-size), or fewer layers (--layers)",
        humanBytes(bytes), humanBytes(static_cast<double>(free_memory)), 1.05 * std::sqrt(bytes / limit)));
}

}  // namespace

std::size_t firstNotBelow(std::span<const std::uint32_t> ranks, std::uint32_t rank, std::size_t of_all) {
    const std::size_t size = ranks.size();
    const auto guess =
        std::min(size - 1, static_cast<std::size_t>(static_cast<double>(size) * rank / static_cast<double>(of_all)));
    // Ranks before `low` are below, ranks from `high` on are not.
    std::size_t low = guess + 1;
    std::size_t high = guess;
    std::size_t step = 8;
    if (ranks[guess] < rank) {
        for (; step < size - low && ranks[low + step] < rank; step *= 2) low += step + 1;
        high = std::min(size, low + step);
    } else {
        for (; step < high && ranks[high - step] >= rank; step *= 2) high -= step;
        low = high - std::min(high, step);
    }
    const auto begin = ranks.begin();
    return static_cast<std::size_t>(
        std::lower_bound(begin + static_cast<std::ptrdiff_t>(low), begin + static_cast<std::ptrdiff_t>(high), rank) -
        begin);
}

PlanBins::PlanBins(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice,
                   std::size_t free_memory) {
    if (stack.beads.empty()) return;
    const Footprints footprints = columnFootprints(toolpath, lattice);
    const Parts found = boundEntries(toolpath, stack, lattice, footprints);
    if (found.columns.empty()) return;
    rectangle_ = found.columns;
    // What the parts count in, and then the ranks: an entry is in one block, and there are so many in the rectangle.
    const auto blocksAlong = [](int first, int last) {
        return static_cast<double>((last >> kBlockBits) - (first >> kBlockBits) + 1);
    };
    const double counted =
        std::min(found.bound, static_cast<double>(found.count) * blocksAlong(rectangle_.i0, rectangle_.i1) *
                                  blocksAlong(rectangle_.j0, rectangle_.j1));
    refuseIfTooLarge(std::max(counted * sizeof(Counts::OfBlock), found.bound * sizeof(std::uint32_t)), free_memory);

    // Calls visit(part, rank, i0, i1, j) for the rows of columns that beads reach, part by part, by rank.
    const auto forEachRow = [&](std::size_t parts, const auto& visit) {
        parallelFor(parts, 1, [&](std::size_t begin, std::size_t end) {
            const std::size_t beads = stack.beads.size();
            for (std::size_t p = begin; p != end; ++p)
                for (std::size_t rank = beads * p / parts; rank != beads * (p + 1) / parts; ++rank)
                    footprints.forEachColumn(toolpath.beads[stack.beads[rank]],
                                             [&](int i0, int i1, int j) { visit(p, rank, i0, i1, j); });
        });
    };
    std::vector<Counts> counts(found.count);
    forEachRow(found.count, [&](std::size_t p, std::size_t, int i0, int i1, int j) {
        forEachBlockOfRow(i0, i1, [&](int x, int first, int last) {
            std::uint32_t* const row = counts[p].row(x, j);
            for (int i = first; i <= last; ++i) ++row[i];
        });
    });
    blocks_ = blocksOf(counts);
    const std::size_t count = blocks_.back().last;
    std::size_t parts = found.count;
    // Without a table for each part if many columns have few beads.
    while (parts > 1 && static_cast<double>(count * parts) > 2 * found.bound + 1e6) parts /= 2;
    refuseIfTooLarge(static_cast<double>(count) * static_cast<double>(sizeof(std::size_t) + sizeof(PlanIndex::Square) +
                                                                      parts * sizeof(std::uint32_t)) +
                         found.bound * sizeof(std::uint32_t),
                     free_memory);
    places_.reserve(count);
    for (const Block& block : blocks_) {
        index_.add(block.x, block.y);
        for (int j = 0; j < kBlockColumns; ++j)
            for (int i = 0; i < kBlockColumns; ++i)
                if (block.has(i, j)) places_.push_back({block.x * kBlockColumns + i, block.y * kBlockColumns + j});
    }

    std::vector<std::uint32_t> next = byColumn(counts, parts, blocks_, index_);
    counts = {};
    // By column, where each part's ranks begin, relative to the block.
    offsets_.assign(count + 1, 0);
    for (const Block& block : blocks_)
        for (std::size_t c = block.first; c < block.last; ++c) {
            auto sum = static_cast<std::uint32_t>(offsets_[c] - offsets_[block.first]);
            for (std::size_t p = 0; p < parts; ++p) sum += std::exchange(next[p * count + c], sum);
            offsets_[c + 1] = offsets_[block.first] + sum;
        }
    ranks_ = HugeArray<std::uint32_t>(offsets_.back());
    std::vector<BlockCursor> cursors(parts);
    forEachRow(parts, [&](std::size_t p, std::size_t rank, int i0, int i1, int j) {
        forEachBlockOfRow(i0, i1, [&](int x, int first, int last) {
            const Block& block = blocks_[cursors[p].number(
                x, j >> kBlockBits, [this](int block_x, int block_y) { return index_.find(block_x, block_y); })];
            std::uint32_t* const ranks = ranks_.data() + offsets_[block.first];
            std::uint32_t* place = next.data() + p * count + block.columnAt(first, j & (kBlockColumns - 1));
            for (int i = first; i <= last; ++i, ++place) ranks[(*place)++] = static_cast<std::uint32_t>(rank);
        });
    });
}

}  // namespace stratum::voxelize
