#include "voxelize/swell/spread.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
namespace {

// Sums weighted by the tent 1 - |n| / (reach + 1) along both axes. Nodes outside the square count as 0.
class Tent {
public:
    explicit Tent(int edge) : edge_(edge), rows_(static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge)) {}

    void sum(const std::vector<double>& values, int reach, std::vector<double>& out) {
        std::fill(rows_.begin(), rows_.end(), 0.0);
        out.assign(values.size(), 0.0);
        for (int step = -reach; step <= reach; ++step) {
            const double weight = 1 - static_cast<double>(std::abs(step)) / (reach + 1);
            const int from = std::max(-step, 0);
            const int to = std::min(edge_ - step, edge_);
            for (int row = 0; row < edge_; ++row)
                add(weight, values.data() + nodeIndex(row, edge_, from + step), to - from,
                    rows_.data() + nodeIndex(row, edge_, from));
        }
        for (int step = -reach; step <= reach; ++step) {
            const double weight = 1 - static_cast<double>(std::abs(step)) / (reach + 1);
            for (int row = std::max(-step, 0); row < std::min(edge_ - step, edge_); ++row)
                add(weight, rows_.data() + nodeIndex(row + step, edge_, 0), edge_,
                    out.data() + nodeIndex(row, edge_, 0));
        }
    }

private:
    static void add(double weight, const double* from, int count, double* to) {
        for (int n = 0; n < count; ++n) to[n] += weight * from[n];
    }

    const int edge_;
    std::vector<double> rows_;
};

}  // namespace

SpreadNodes::SpreadNodes(int the_edge) : edge(the_edge) {
    const std::size_t count = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
    surplus.assign(count, 0.0);
    for (std::vector<double>& level : gain) level.assign(count, 0.0);
}

std::vector<double> spreadSurplus(const SpreadNodes& nodes) {
    const std::vector<double>& most = nodes.gain.back();
    const std::size_t count = most.size();
    Tent tent(nodes.edge);
    std::vector<double> given(count, 0.0);
    std::vector<double> left = nodes.surplus;
    std::vector<double> room = most;
    std::vector<double> around(count);
    std::vector<double> offered(count);
    std::vector<double> taken(count);
    // What a node sends for each mm^3 of `places` around it. Where there are none, it keeps what it has.
    const auto send = [&](const std::vector<double>& places, int reach, bool positive, std::vector<double>& sums) {
        tent.sum(places, reach, around);
        for (std::size_t n = 0; n < count; ++n) {
            const bool sends = around[n] > 0 && (left[n] > 0) == positive;
            around[n] = sends ? left[n] / around[n] : 0;
            if (sends) left[n] = 0;
        }
        tent.sum(around, reach, sums);
    };
    for (const int reach : {kNear, kFar}) {
        send(room, reach, true, offered);
        // What a free end holds more than it was fed, others were given too much: it is taken back.
        send(given, reach, false, taken);
        for (std::size_t n = 0; n < count; ++n) {
            const double wanted = given[n] * (1 + taken[n]) + room[n] * offered[n];
            given[n] = std::clamp(wanted, 0.0, most[n]);
            left[n] += wanted - given[n];
            room[n] = most[n] - given[n];
        }
    }
    return given;
}

double swellThatGains(const SpreadNodes& nodes, std::size_t n, double given) {
    double before = 0;
    for (std::size_t level = 0; level < nodes.gain.size(); ++level) {
        const double gain = nodes.gain[level][n];
        if (given <= gain && gain > before) {
            const double steps = static_cast<double>(level) + (given - before) / (gain - before);
            return std::min(kMostSwell * steps / TileSums::kLevels, kMostSwell);
        }
        before = std::max(before, gain);
    }
    return given > 0 ? kMostSwell : 0;
}

}  // namespace stratum::voxelize
