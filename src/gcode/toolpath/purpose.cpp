#include "gcode/toolpath/purpose.h"

#include "base/union_find.h"
#include "gcode/toolpath/plan_path.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr double kSkirtLayers = 3;
constexpr double kMostCell = 2;     // mm; a wider line is a damaged number, or a purge
constexpr int kPrimeCells = 4;      // that prime lines are wide at most
constexpr int kBrimCells = 3;       // that a brim is wide at least
constexpr double kCrossing = 0.05;  // of a brim's length
constexpr double kMostSteps = 2e7;  // along the lines near the bed; a bed of a square metre has 2e6 in a layer
constexpr double kThread = 0.1;     // of the usual width: thinner lines are threads of a move that extrudes

Purpose ofTag(Feature feature) {
    switch (feature) {
        case Feature::skirt:
        case Feature::wipe_tower:
        case Feature::custom:
            return Purpose::beside;
        case Feature::brim:
            return Purpose::brim;
        case Feature::support:
        case Feature::support_interface:
            return Purpose::support;
        default:
            return Purpose::part;
    }
}

struct PlanCell {
    std::int32_t i = 0, j = 0;
    std::uint64_t key() const {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)) << 32U | static_cast<std::uint32_t>(j);
    }
    PlanCell beside(int di, int dj) const { return {i + di, j + dj}; }
};

// In cells, both ends included.
struct PlanBox {
    PlanCell low{INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN};
    void include(PlanCell cell) {
        low = {std::min(low.i, cell.i), std::min(low.j, cell.j)};
        high = {std::max(high.i, cell.i), std::max(high.j, cell.j)};
    }
    // With room on all sides.
    bool holds(const PlanBox& other) const {
        return low.i < other.low.i && low.j < other.low.j && high.i > other.high.i && high.j > other.high.j;
    }
};

// The beads near the bed on a lattice whose cells are as wide as a line: those that touch lie in the same cell or in
// neighbours.
class NearBed {
public:
    NearBed(const Toolpath& toolpath, std::vector<Purpose>& purposes) : toolpath_(toolpath), purposes_(purposes) {}

    void tell() {
        measure();
        for (std::uint32_t bead = 0; bead < toolpath_.beads.size(); ++bead) {
            if (toolpath_.runOf(toolpath_.beads[bead]).layer == 0 || topOf(bead) > above_) continue;
            if (isUnknown(bead) && toolpath_.beads[bead].width < kThread * cell_)
                purposes_[bead] = Purpose::beside;
            else
                beads_.push_back(bead);
        }
        if (beads_.empty() || steps() > kMostSteps) return;
        findIslands();
        const bool any_goes_on =
            std::any_of(islands_.begin(), islands_.end(), [](const auto& island) { return island.second.goes_on; });
        if (!any_goes_on) return;
        for (auto& [first, island] : islands_)
            if (island.unknown && !island.goes_on && (isSkirt(island) || isPrime(island)))
                for (const std::uint32_t bead : island.beads) purposes_[bead] = Purpose::beside;
        for (auto& [first, island] : islands_)
            if (island.goes_on) tellBrim(island);
    }

private:
    struct Island {
        std::vector<std::uint32_t> beads;
        PlanBox box;
        double top = -1e300;
        bool unknown = true;   // no bead has a tag
        bool goes_on = false;  // above the layers of skirts
    };
    using PlanCells = std::unordered_map<std::uint64_t, std::uint32_t>;  // to the first bead there

    double topOf(std::uint32_t bead) const {
        return std::max<double>(toolpath_.beads[bead].z0, toolpath_.beads[bead].z1);
    }
    bool isUnknown(std::uint32_t bead) const {
        return toolpath_.runOf(toolpath_.beads[bead]).feature == Feature::unknown;
    }
    bool isFirst(std::uint32_t bead) const { return topOf(bead) <= first_layer_; }

    // The usual height and width, and the planes that part the layers near the bed.
    void measure() {
        std::map<std::int64_t, double> heights;
        std::map<std::int64_t, double> widths;
        double lowest = 1e300;
        for (const Bead& bead : toolpath_.beads) {
            const Run& run = toolpath_.runOf(bead);
            if (run.layer == 0) continue;
            const double length = beadLength(toolpath_, bead);
            heights[std::llround(static_cast<double>(run.height) * 1e3)] += length;
            widths[std::llround(static_cast<double>(bead.width) * 1e2)] += length;
            lowest = std::min<double>(lowest, std::min<double>(bead.z0, bead.z1));
        }
        if (heights.empty()) return;
        const auto longest = [](const auto& lengths) {
            return std::max_element(lengths.begin(), lengths.end(),
                                    [](const auto& a, const auto& b) { return a.second < b.second; })
                ->first;
        };
        const double height = 1e-3 * static_cast<double>(longest(heights));
        cell_ = std::clamp(1e-2 * static_cast<double>(longest(widths)), 0.05, kMostCell);
        first_layer_ = lowest + 0.5 * height;
        skirt_ = lowest + (kSkirtLayers - 0.5) * height;
        above_ = skirt_ + height;
    }

    int stepsAlong(std::uint32_t index) const {
        const double length = std::min(beadLength(toolpath_, toolpath_.beads[index]), 1e5);
        return std::max(1, static_cast<int>(std::ceil(length / (0.5 * cell_))));
    }
    double steps() const {
        double sum = 0;
        for (const std::uint32_t bead : beads_) sum += stepsAlong(bead);
        return sum;
    }

    // Calls visit() for the cells along a bead.
    template <typename Visit>
    void alongBead(std::uint32_t index, const Visit& visit) const {
        const PlanPath path(toolpath_, toolpath_.beads[index]);
        const int steps = stepsAlong(index);
        PlanCell last;
        for (int n = 0; n <= steps; ++n) {
            const PlanPoint place = path.at(path.length() * n / steps);
            const PlanCell cell{static_cast<std::int32_t>(std::floor(std::clamp(place.x / cell_, -1e9, 1e9))),
                                static_cast<std::int32_t>(std::floor(std::clamp(place.y / cell_, -1e9, 1e9)))};
            if (n == 0 || cell.key() != last.key()) visit(cell);
            last = cell;
        }
    }

    void findIslands() {
        UnionFind sets(beads_.size());
        PlanCells cells;
        for (std::uint32_t n = 0; n < beads_.size(); ++n)
            alongBead(beads_[n], [&](PlanCell cell) {
                for (int di = -1; di <= 1; ++di)
                    for (int dj = -1; dj <= 1; ++dj) {
                        const auto found = cells.find(cell.beside(di, dj).key());
                        if (found != cells.end()) sets.join(found->second, n);
                    }
                cells.emplace(cell.key(), n);
            });
        for (std::uint32_t n = 0; n < beads_.size(); ++n) {
            Island& island = islands_[sets.find(n)];
            island.beads.push_back(beads_[n]);
            island.top = std::max(island.top, topOf(beads_[n]));
            island.unknown = island.unknown && isUnknown(beads_[n]);
            alongBead(beads_[n], [&island](PlanCell cell) { island.box.include(cell); });
        }
        for (auto& [first, island] : islands_) island.goes_on = island.top > skirt_;
    }

    // Before all other beads. Where a part does not begin with a level layer, prime lines may lie above its lowest
    // beads.
    bool isPrintedFirst(const Island& island) const {
        return island.beads.front() == beads_.front() &&
               island.beads.back() - island.beads.front() + 1 == island.beads.size();
    }

    bool isSkirt(const Island& island) const {
        return std::any_of(islands_.begin(), islands_.end(), [&island](const auto& other) {
            return other.second.goes_on && island.box.holds(other.second.box);
        });
    }

    bool isPrime(const Island& island) const {
        if (island.top > first_layer_ && !isPrintedFirst(island)) return false;
        PlanCells cells;
        for (const std::uint32_t bead : island.beads)
            alongBead(bead, [&](PlanCell cell) { cells.emplace(cell.key(), bead); });
        // Wider than the lines: a square full of them.
        for (const std::uint32_t bead : island.beads) {
            bool wide = false;
            alongBead(bead, [&](PlanCell cell) {
                bool full = !wide;
                for (int di = 0; di <= kPrimeCells && full; ++di)
                    for (int dj = 0; dj <= kPrimeCells && full; ++dj) full = cells.contains(cell.beside(di, dj).key());
                wide = wide || full;
            });
            if (wide) return false;
        }
        return true;
    }

    // The cells within the outline of what lies above the first layer: those that a flood from outside doesn't reach.
    class Outline {
    public:
        Outline(const PlanBox& box, const std::vector<PlanCell>& walls)
            : low_(box.low.beside(-1, -1)),
              rows_(static_cast<std::size_t>(box.high.j - box.low.j) + 3),
              cells_((static_cast<std::size_t>(box.high.i - box.low.i) + 3) * rows_, kInside) {
            for (const PlanCell& wall : walls) at(wall) = kWall;
            std::vector<PlanCell> open{low_};
            at(low_) = 1;
            // By steps from side to side: walls whose cells share a corner hold it back.
            const auto last_i = static_cast<std::int32_t>(cells_.size() / rows_) - 1;
            const auto last_j = static_cast<std::int32_t>(rows_) - 1;
            while (!open.empty()) {
                const PlanCell cell = open.back();
                open.pop_back();
                for (const auto& [di, dj] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
                    const PlanCell next = cell.beside(di, dj);
                    if (next.i < low_.i || next.j < low_.j || next.i > low_.i + last_i || next.j > low_.j + last_j)
                        continue;
                    if (at(next) != kInside) continue;
                    at(next) = 1;
                    open.push_back(next);
                }
            }
        }
        // Whether nothing within so many cells is inside.
        bool isClear(PlanCell cell, int reach) {
            for (int di = -reach; di <= reach; ++di)
                for (int dj = -reach; dj <= reach; ++dj) {
                    const PlanCell near = cell.beside(di, dj);
                    if (near.i < low_.i || near.j < low_.j || static_cast<std::size_t>(near.j - low_.j) >= rows_ ||
                        index(near) >= cells_.size())
                        continue;
                    if (at(near) != 1) return false;
                }
            return true;
        }

    private:
        static constexpr std::uint8_t kInside = 0, kWall = 2;
        std::size_t index(PlanCell cell) const {
            return static_cast<std::size_t>(cell.i - low_.i) * rows_ + static_cast<std::size_t>(cell.j - low_.j);
        }
        std::uint8_t& at(PlanCell cell) { return cells_[index(cell)]; }

        PlanCell low_;
        std::size_t rows_;
        std::vector<std::uint8_t> cells_;
    };

    void tellBrim(const Island& island) {
        constexpr double kMostCells = 1e8;
        if ((1.0 + island.box.high.i - island.box.low.i) * (1.0 + island.box.high.j - island.box.low.j) > kMostCells)
            return;
        std::vector<PlanCell> walls;
        PlanBox above;
        for (const std::uint32_t bead : island.beads)
            if (!isFirst(bead)) alongBead(bead, [&](PlanCell cell) { walls.push_back(cell), above.include(cell); });
        if (walls.empty() || !island.box.holds(above)) return;
        Outline outline(island.box, walls);
        std::vector<std::uint32_t> brim;
        PlanBox around;
        double length = 0;
        double crossing = 0;
        bool wide = false;
        for (const std::uint32_t bead : island.beads) {
            if (!isFirst(bead) || !isUnknown(bead)) continue;
            bool outside = true;
            bool far = false;
            alongBead(bead, [&](PlanCell cell) {
                outside = outside && outline.isClear(cell, 1);
                far = far || outline.isClear(cell, kBrimCells);
            });
            if (outside) {
                brim.push_back(bead);
                length += beadLength(toolpath_, toolpath_.beads[bead]);
                alongBead(bead, [&around](PlanCell cell) { around.include(cell); });
            } else if (far) {
                crossing += beadLength(toolpath_, toolpath_.beads[bead]);
            }
            wide = wide || far;
        }
        if (!wide || crossing > kCrossing * length || !around.holds(above)) return;
        for (const std::uint32_t bead : brim) purposes_[bead] = Purpose::brim;
    }

    const Toolpath& toolpath_;
    std::vector<Purpose>& purposes_;
    double cell_ = 1;                                      // mm
    double first_layer_ = 0, skirt_ = 0, above_ = -1e300;  // mm: nozzles of layers are below
    std::vector<std::uint32_t> beads_;
    std::map<std::uint32_t, Island> islands_;
};

}  // namespace

std::vector<Purpose> purposesOf(const Toolpath& toolpath) {
    std::vector<Purpose> of_run;
    of_run.reserve(toolpath.runs.size());
    bool untagged = false;
    for (const Run& run : toolpath.runs) {
        of_run.push_back(run.layer == 0 ? Purpose::beside : ofTag(run.feature));
        untagged = untagged || (run.layer > 0 && run.feature == Feature::unknown);
    }
    std::vector<Purpose> purposes;
    purposes.reserve(toolpath.beads.size());
    for (const Bead& bead : toolpath.beads) purposes.push_back(of_run[bead.run]);
    if (untagged) NearBed(toolpath, purposes).tell();
    return purposes;
}

std::vector<std::uint32_t> beadsUpTo(Purpose last, std::span<const Purpose> purposes,
                                     std::span<const std::uint32_t> selection) {
    std::vector<std::uint32_t> kept;
    kept.reserve(selection.size());
    std::copy_if(selection.begin(), selection.end(), std::back_inserter(kept),
                 [&](std::uint32_t bead) { return purposes[bead] <= last; });
    if (kept.empty()) kept.assign(selection.begin(), selection.end());
    return kept;
}

}  // namespace stratum::gcode
