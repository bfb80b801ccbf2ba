#include "mechanics/solid_elements.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "base/union_find.h"
#include "mechanics/cube_neighbors.h"
#include "mechanics/cube_shares.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/grid/solid_check.h"
#include "voxelize/leaf/print_columns.h"

#include <fmt/format.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <tuple>
#include <vector>

namespace stratum::mechanics {
namespace {

[[noreturn]] void refuse(double count, const SolidOptions& options, double edge) {
    // The number falls with the cube of the size; a tenth more for what that leaves out.
    const double fits = edge * std::cbrt(1.1 * count / static_cast<double>(options.most));
    throw UsageError(
        fmt::format("about {:.3g} elements of {:g} mm are more than the {} nodes that are allowed; choose --voxel-size "
                    "{:.2g} or more, fewer layers or features, or a higher --max-nodes",
                    count, edge, options.most, std::ceil(fits * 100) / 100));
}

}  // namespace

SolidElements solidElements(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                            const voxelize::Lattice& lattice, const SolidOptions& options) {
    const double edge = lattice.voxel_size;
    if (lattice.layer_height / edge > kMostPerLayer)
        throw UsageError(
            fmt::format("elements of {:g} mm are less than a {:g}th of a layer of {:g} mm; choose --voxel-size "
                        "{:.2g} or more",
                        edge, kMostPerLayer, lattice.layer_height, lattice.layer_height / kMostPerLayer));
    // Beads overlap: the solid is less than what they hold, but not much.
    const double expected = voxelize::depositedVolume(toolpath, selection) / (edge * edge * edge);
    if (options.most > 0 && expected > 2.0 * static_cast<double>(options.most)) refuse(expected, options, edge);

    const CubeShares cubes = cubeShares(toolpath, selection, lattice, options.progress);
    const std::vector<std::uint32_t> chosen = chosenCubes(cubes);
    if (options.most > 0 && chosen.size() > options.most)
        refuse(std::max(expected, static_cast<double>(options.most)), options, edge);

    SolidElements elements;
    elements.edge = edge;
    std::copy_n(cubes.origin, 3, elements.origin);
    elements.plastic = cubes.plastic * edge * edge * edge;
    elements.list.reserve(chosen.size());
    for (const std::uint32_t n : chosen) {
        const CubeShare& cube = cubes.list[n];
        elements.list.push_back({cube.i, cube.j, cube.k, selection.front()});
    }
    setBeads(toolpath, selection, lattice, elements);
    return elements;
}

namespace {

constexpr int kBlockBits = 5;
// Fuller cubes are alike, and shares that differ by less than kScatter are taken in a scattered order. By share alone
// whole rows of cubes between two lines would be left out, which are less full than the lines' own, and the lines would
// no longer be joined.
constexpr double kMostlyFull = 0.6;
constexpr double kScatter = 0.5;
// Not so where a cube and its neighbours in the plan are this empty on average, as those of a wall thinner than they
// are: the wall's cubes are taken one after the other, by their shares in so many steps.
constexpr double kThin = 0.35;
constexpr double kSteps = 32;

// A number in 0..1 for each place, evenly spread (Roberts' R3 sequence, of the root of x^4 = x + 1).
double scatteredAt(const CubeShare& cube) {
    const double at = 0.8191725133961645 * cube.i + 0.6710436067037893 * cube.j + 0.5497004779019703 * cube.k;
    return at - std::floor(at);
}

class Chooser {
public:
    explicit Chooser(const CubeShares& cubes)
        : list_(cubes.list), neighbors_(cubeNeighbors(list_)), chosen_(list_.size()), joint_(list_.size()) {
        orderByBlock();
    }

    std::vector<std::uint32_t> choose() {
        fillBlocks();
        joinPieces();
        leaveOut();
        std::vector<std::uint32_t> found;
        for (std::uint32_t n = 0; n < list_.size(); ++n)
            if (chosen_[n] != 0) found.push_back(n);
        return found;
    }

private:
    auto block(std::uint32_t n) const {
        // An arithmetic shift is a division that rounds down.
        return std::tuple(list_[n].k >> kBlockBits, list_[n].j >> kBlockBits, list_[n].i >> kBlockBits);
    }

    // Greater ones are taken first.
    double keyOf(std::uint32_t n) const {
        const double share = list_[n].share;
        double around = share;
        for (const std::size_t side : {x_low, x_high, y_low, y_high})
            if (const std::uint32_t other = neighbors_[n][side]; other != kNoCube) around += list_[other].share;
        if (around / 5 < kThin) return std::round(share * kSteps) / kSteps;
        return std::min(share, kMostlyFull) + kScatter * scatteredAt(list_[n]);
    }

    // Block by block, in each the fullest first.
    void orderByBlock() {
        order_.resize(list_.size());
        std::iota(order_.begin(), order_.end(), 0U);
        std::vector<double> keys;
        keys.reserve(list_.size());
        for (std::uint32_t n = 0; n < list_.size(); ++n) keys.push_back(keyOf(n));
        const auto rank = [this, &keys](std::uint32_t n) {
            return std::tuple(block(n), -keys[n], list_[n].j, list_[n].i, list_[n].k);
        };
        tbb::parallel_sort(order_.begin(), order_.end(),
                           [&](std::uint32_t a, std::uint32_t b) { return rank(a) < rank(b); });
        for (std::size_t n = 0; n < order_.size(); ++n)
            if (n == 0 || block(order_[n]) != block(order_[n - 1])) first_.push_back(n);
        first_.push_back(order_.size());
    }

    std::span<const std::uint32_t> cubesOf(std::size_t block) const {
        return std::span(order_).subspan(first_[block], first_[block + 1] - first_[block]);
    }

    void fillBlocks() {
        double open = 0;
        for (std::size_t b = 0; b + 1 < first_.size(); ++b) {
            for (const std::uint32_t n : cubesOf(b)) open += list_[n].share;
            for (const std::uint32_t n : cubesOf(b)) {
                if (open < 0.5) break;
                chosen_[n] = 1;
                open -= 1;
            }
        }
    }

    bool joined(std::uint32_t from, std::size_t side) const {
        const std::uint32_t to = neighbors_[from][side];
        return (list_[from].reached >> side & 1) != 0 && (list_[to].reached >> (side ^ 1) & 1) != 0;
    }

    // Ways from every piece at once through what is not chosen; where two meet, they may be joined. The cheapest joins
    // come first (Kruskal), until all is joined that the plastic joins.
    void joinPieces() {
        UnionFind pieces(list_.size());
        using Open = std::pair<double, std::uint32_t>;  // cost of the way to a cube
        std::priority_queue<Open, std::vector<Open>, std::greater<>> open;
        std::vector<double> cost(list_.size(), std::numeric_limits<double>::infinity());
        std::vector<std::uint32_t> from(list_.size(), kNoCube);
        for (std::uint32_t n = 0; n < list_.size(); ++n) {
            if (chosen_[n] == 0) continue;
            cost[n] = 0;
            bool inner = true;  // between chosen ones
            for (std::size_t side = 0; side < kCubeSides; ++side) {
                const std::uint32_t other = neighbors_[n][side];
                if (other == kNoCube) continue;
                if (chosen_[other] != 0) pieces.join(n, other);
                inner = inner && chosen_[other] != 0;
            }
            if (!inner) open.push({0, n});
        }
        std::vector<std::uint32_t> piece(list_.size(), kNoCube);
        for (std::uint32_t n = 0; n < list_.size(); ++n)
            if (chosen_[n] != 0) piece[n] = pieces.find(n);
        struct Meeting {
            double cost;
            std::uint32_t a, b;
        };
        std::vector<Meeting> meetings;
        while (!open.empty()) {
            const auto [paid, n] = open.top();
            open.pop();
            if (paid > cost[n]) continue;
            for (std::size_t side = 0; side < kCubeSides; ++side) {
                const std::uint32_t other = neighbors_[n][side];
                if (other == kNoCube || !joined(n, side)) continue;
                const double price = paid + (chosen_[other] != 0 ? 0 : 1 - 0.9 * list_[other].share);
                if (price < cost[other]) {
                    cost[other] = price;
                    from[other] = n;
                    piece[other] = piece[n];
                    open.push({price, other});
                } else if (piece[other] != kNoCube && piece[other] != piece[n]) {
                    meetings.push_back({paid + cost[other], n, other});
                }
            }
        }
        std::sort(meetings.begin(), meetings.end(), [](const Meeting& a, const Meeting& b) {
            return std::tie(a.cost, a.a, a.b) < std::tie(b.cost, b.a, b.b);
        });
        for (const Meeting& meeting : meetings) {
            if (!pieces.join(piece[meeting.a], piece[meeting.b])) continue;
            for (std::uint32_t n : {meeting.a, meeting.b})
                for (; n != kNoCube && chosen_[n] == 0; n = from[n]) chosen_[n] = joint_[n] = 1;
        }
    }

    // Whether its chosen neighbours are joined without it, by cubes that share a face or an edge with it.
    bool spare(std::uint32_t n) const {
        const auto solid = [this](std::uint32_t at) { return at != kNoCube && chosen_[at] != 0; };
        UnionFind sides(kCubeSides);
        int count = 0;
        int joins = 0;
        for (std::uint32_t a = 0; a < kCubeSides; ++a) {
            const std::uint32_t one = neighbors_[n][a];
            if (!solid(one)) continue;
            ++count;
            for (std::uint32_t b = 0; b < a - (a & 1); ++b)
                if (solid(neighbors_[n][b]) && solid(neighbors_[one][b])) joins += sides.join(a, b) ? 1 : 0;
        }
        return count > 0 && joins == count - 1;
    }

    void leaveOut() {
        double over = 0;
        for (std::size_t b = 0; b + 1 < first_.size(); ++b) {
            const std::span<const std::uint32_t> cubes = cubesOf(b);
            for (const std::uint32_t n : cubes) over += chosen_[n] - static_cast<double>(list_[n].share);
            bool changed = true;
            while (over > 0.5 && changed) {
                changed = false;
                for (std::size_t m = cubes.size(); m-- > 0 && over > 0.5;) {
                    const std::uint32_t n = cubes[m];
                    if (chosen_[n] == 0 || joint_[n] != 0 || !spare(n)) continue;
                    chosen_[n] = 0;
                    over -= 1;
                    changed = true;
                }
            }
        }
    }

    const std::vector<CubeShare>& list_;
    std::vector<CubeNeighbors> neighbors_;
    std::vector<std::uint8_t> chosen_, joint_;
    std::vector<std::uint32_t> order_;
    std::vector<std::size_t> first_;  // of order_, a block each, and the end
};

}  // namespace

std::vector<std::uint32_t> chosenCubes(const CubeShares& cubes) { return Chooser(cubes).choose(); }

namespace {

using voxelize::kLeafDim;

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

// Samples in the middles of cubes.
voxelize::Lattice middlesOf(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack,
                            const voxelize::Lattice& lattice, const SolidElements& elements) {
    voxelize::Lattice middles = lattice;
    middles.origin_z = elements.origin[2] + 0.5 * elements.edge;
    // Owners are known within the band: it must reach the middle of every bead, and plastic in a cube's corner.
    double thickest = 0;
    for (const voxelize::Layer& layer : stack.layers) thickest = std::max(thickest, layer.halfHeight());
    for (const std::uint32_t bead : stack.direct())
        thickest = std::max(thickest, voxelize::sectionOf(toolpath, toolpath.beads[bead]).halfHeight());
    middles.half_width = std::max(3.0, thickest / elements.edge + 2);
    return middles;
}

// A shift rounds down, also below 0.
constexpr int kLeafBits = 3;
static_assert(kLeafDim == 1 << kLeafBits);

}  // namespace

void setBeads(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
              const voxelize::Lattice& lattice, SolidElements& elements) {
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, selection);
    const voxelize::Lattice middles = middlesOf(toolpath, stack, lattice, elements);
    const voxelize::PrintColumns columns(toolpath, stack, middles, 1, voxelize::LeafColumn::Kind::values,
                                         availableMemory());
    if (columns.size() == 0 || elements.list.empty()) return;
    std::vector<SolidElement>& list = elements.list;

    // By column of leaves, from the bottom.
    std::vector<std::uint32_t> order(list.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto leaf = [&list](std::uint32_t n) {
        return std::tuple(list[n].j >> kLeafBits, list[n].i >> kLeafBits, list[n].k >> kLeafBits);
    };
    tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return std::tuple_cat(leaf(a), std::tuple(a)) < std::tuple_cat(leaf(b), std::tuple(b));
    });
    const auto same_column = [&leaf](std::uint32_t a, std::uint32_t b) {
        return std::get<0>(leaf(a)) == std::get<0>(leaf(b)) && std::get<1>(leaf(a)) == std::get<1>(leaf(b));
    };
    std::vector<std::size_t> first;
    for (std::size_t n = 0; n < order.size(); ++n)
        if (n == 0 || !same_column(order[n], order[n - 1])) first.push_back(n);
    first.push_back(order.size());

    parallelFor(first.size() - 1, 16, [&](std::size_t begin, std::size_t end) {
        std::array<std::uint32_t, voxelize::Leaf::SIZE> owners;
        for (std::size_t c = begin; c < end; ++c) {
            const int i = list[order[first[c]]].i >> kLeafBits << kLeafBits;
            const int j = list[order[first[c]]].j >> kLeafBits << kLeafBits;
            const std::size_t bin = columns.bins().find(i >> kLeafBits, j >> kLeafBits);
            if (bin == voxelize::PlanBins::kNone) continue;
            voxelize::LeafColumn& column = columns.open(bin);
            int evaluated = std::numeric_limits<int>::min();
            for (std::size_t n = first[c]; n < first[c + 1]; ++n) {
                SolidElement& e = list[order[n]];
                if (e.k >> kLeafBits != evaluated) {
                    evaluated = e.k >> kLeafBits;
                    column.evaluate(evaluated);
                    column.owners(owners);
                }
                const int place = ((e.i - i) * kLeafDim + e.j - j) * kLeafDim + (e.k & (kLeafDim - 1));
                const std::uint32_t rank = owners[static_cast<std::size_t>(place)];
                if (rank != kNobody) e.bead = stack.beads[rank];
            }
        }
    });
}

}  // namespace stratum::mechanics
