#include "mechanics/chosen_cubes.h"

#include "base/union_find.h"
#include "mechanics/cube_neighbors.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>

namespace stratum::mechanics {
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

}  // namespace stratum::mechanics
