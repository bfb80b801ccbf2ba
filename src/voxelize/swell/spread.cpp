#include "voxelize/swell/spread.h"

#include "voxelize/swell/tent.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {
SpreadNodes::SpreadNodes(int the_edge) : edge(the_edge) {
    const std::size_t count = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
    surplus.assign(count, 0.0F);
    for (std::vector<float>& level : gain) level.assign(count, 0.0F);
    open.assign(count, 0.0F);
}

Spread spreadSurplus(const SpreadNodes& nodes, double most_rise) {
    const auto most_height = static_cast<float>(most_rise);
    const std::vector<float>& most = nodes.gain.back();
    const std::size_t count = most.size();
    Tent tent(nodes.edge);
    Spread spread{std::vector<float>(count, 0.0F), std::vector<float>(count, 0.0F), nodes.surplus};
    std::vector<float>& given = spread.given;
    std::vector<float>& left = spread.left;
    std::vector<float> room = most;
    std::vector<float> around(count);
    std::vector<float> offered(count);
    std::vector<float> taken(count, 0.0F);
    // What nodes send to one for each mm^3, or mm^2, of its `places`, and in proportion to theirs: what `sends` chooses
    // of what they have left. Where there are no places, it stays.
    const auto send = [&](const std::vector<float>& places, int reach, std::vector<float>& sums, const auto& sends) {
        tent.sum(places, reach, around);
        for (std::size_t n = 0; n < count; ++n) {
            const bool goes = around[n] > 0 && sends(left[n]);
            around[n] = goes ? left[n] / around[n] : 0;
            if (goes) left[n] = 0;
        }
        tent.sum(around, reach, sums);
    };
    const auto surplus = [](float volume) { return volume > 0; };
    const auto lack = [](float volume) { return volume < 0; };
    const auto both = [](float) { return true; };
    const auto moveOut = [&](int reach, bool first) {
        send(room, reach, offered, surplus);
        // What a free end holds more than it was fed, others were given too much: it is taken back.
        if (!first) send(given, reach, taken, lack);
        for (std::size_t n = 0; n < count; ++n) {
            const float wanted = given[n] * (1 + taken[n]) + room[n] * offered[n];
            given[n] = std::clamp(wanted, 0.0F, most[n]);
            left[n] += wanted - given[n];
            room[n] = most[n] - given[n];
        }
    };
    moveOut(kNear, true);
    if (std::any_of(nodes.open.begin(), nodes.open.end(), [](float area) { return area > 0; })) {
        // Of both signs: what a node lacks, its neighbours' surplus fills first.
        send(nodes.open, kUp, offered, both);
        for (std::size_t n = 0; n < count; ++n) {
            const float wanted = nodes.open[n] * offered[n];
            spread.raised[n] = std::clamp(wanted, 0.0F, nodes.open[n] * most_height);
            left[n] += wanted - spread.raised[n];
        }
    }
    moveOut(kFar, false);
    return spread;
}

double swellThatGains(const SpreadNodes& nodes, std::size_t n, double given) {
    double before = 0;
    for (std::size_t level = 0; level < nodes.gain.size(); ++level) {
        const auto gain = static_cast<double>(nodes.gain[level][n]);
        if (given <= gain && gain > before) {
            const double steps = static_cast<double>(level) + (given - before) / (gain - before);
            return std::min(kMostSwell * steps / TileSums::kLevels, kMostSwell);
        }
        before = std::max(before, gain);
    }
    return given > 0 ? kMostSwell : 0;
}

}  // namespace stratum::voxelize
