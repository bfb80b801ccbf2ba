#include "voxelize/swell/spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::voxelize {

SpreadNodes::SpreadNodes(int the_edge) : edge(the_edge) {
    const std::size_t count = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
    surplus.assign(count, 0.0F);
    for (std::vector<float>& level : gain) level.assign(count, 0.0F);
    open.assign(count, 0.0F);
}

void SpreadNodes::clear(const NodeBox& where) {
    if (where.empty()) return;
    for (int row = where.y0; row < where.y1; ++row) {
        const auto clearRow = [&](std::vector<float>& values) {
            std::fill_n(values.data() + nodeIndex(row, edge, where.x0), where.x1 - where.x0, 0.0F);
        };
        clearRow(surplus);
        for (std::vector<float>& level : gain) clearRow(level);
        clearRow(open);
    }
}

Spreading::Spreading(int edge) : edge_(edge), tent_(edge) {
    const std::size_t count = static_cast<std::size_t>(edge) * static_cast<std::size_t>(edge);
    for (std::vector<float>* values :
         {&spread_.given, &spread_.raised, &spread_.left, &room_, &around_, &offered_, &placed_, &taken_})
        values->assign(count, 0.0F);
}

template <typename Visit>
void Spreading::forEach(const NodeBox& box, Visit visit) const {
    for (int row = box.y0; row < box.y1; ++row) {
        const std::size_t first = nodeIndex(row, edge_, 0);
        for (std::size_t n = first + static_cast<std::size_t>(box.x0); n < first + static_cast<std::size_t>(box.x1);
             ++n)
            visit(n);
    }
}

void Spreading::send(const std::vector<float>& places, int reach, Sign sign, const NodeBox& to,
                     std::vector<float>& sums) {
    const NodeBox from = to.grown(reach).within(box_);
    tent_.sum(places, box_, reach, from, around_);
    const float least = sign == Sign::surplus ? 0.0F : std::numeric_limits<float>::lowest();
    const float most = sign == Sign::lack ? 0.0F : std::numeric_limits<float>::max();
    float* const around = around_.data();
    float* const left = spread_.left.data();
    // Without branches, for several nodes at a time.
    forEach(from, [=](std::size_t n) {
        const float volume = left[n];
        const float place = around[n];
        const bool goes = (place > 0) & (volume > least) & (volume < most);
        around[n] = goes ? volume / place : 0.0F;
        left[n] = goes ? 0.0F : volume;
    });
    tent_.sum(around_, from, reach, to, sums);
}

void Spreading::moveOut(const std::vector<float>& most, int reach, bool take_back, const NodeBox& to) {
    float* const given = spread_.given.data();
    float* const raised = spread_.raised.data();
    float* const left = spread_.left.data();
    send(room_, reach, Sign::surplus, to, offered_);
    // What a node holds more than it was fed, others were given too much: it is taken back.
    if (take_back) {
        float* const placed = placed_.data();
        forEach(to.grown(2 * reach).within(box_), [=](std::size_t n) { placed[n] = given[n] + raised[n]; });
        send(placed_, reach, Sign::lack, to, taken_);
    }
    float* const room = room_.data();
    const float* const limit = most.data();
    const float* const offered = offered_.data();
    const float* const taken = taken_.data();
    forEach(to, [=](std::size_t n) {
        const float share = take_back ? 1 + taken[n] : 1;
        const float kept = std::max(share, 0.0F);
        const float wanted = given[n] * kept + room[n] * offered[n];
        const float gets = std::min(wanted, limit[n]);
        left[n] += wanted - gets + (given[n] + raised[n]) * (share - kept);
        given[n] = gets;
        raised[n] *= kept;
        room[n] = limit[n] - gets;
    });
}

void Spreading::raise(const std::vector<float>& open, float most_height, const NodeBox& to) {
    // Of both signs: what a node lacks, its neighbours' surplus fills first.
    send(open, kUp, Sign::both, to, offered_);
    float* const raised = spread_.raised.data();
    float* const left = spread_.left.data();
    const float* const area = open.data();
    const float* const offered = offered_.data();
    forEach(to, [=](std::size_t n) {
        const float wanted = area[n] * offered[n];
        const float gets = std::min(std::max(wanted, 0.0F), area[n] * most_height);
        raised[n] = gets;
        left[n] += wanted - gets;
    });
}

const Spread& Spreading::spread(const SpreadNodes& nodes, const NodeBox& box, const NodeBox& wanted, double most_rise) {
    const auto around = [&](int reach) { return wanted.grown(reach).within(NodeBox::all(edge_)); };
    forEach(wanted, [this](std::size_t n) { spread_.given[n] = spread_.raised[n] = spread_.left[n] = 0; });
    box_ = box.within(around(kSpreadHalo));
    bool any_surplus = false;
    bool any_open = false;
    forEach(box_, [&](std::size_t n) {
        spread_.given[n] = spread_.raised[n] = 0;
        spread_.left[n] = nodes.surplus[n];
        room_[n] = nodes.gain.back()[n];
        any_surplus |= nodes.surplus[n] > 0;
        any_open |= nodes.open[n] > 0;
    });
    if (!any_surplus) return spread_;
    // What a step makes right, the next needs a little farther out than it is right itself.
    moveOut(nodes.gain.back(), kNear, false, around(2 * kFar + kUp).within(box_));
    if (any_open) raise(nodes.open, static_cast<float>(most_rise), around(2 * kFar).within(box_));
    moveOut(nodes.gain.back(), kFar, true, around(0).within(box_));
    return spread_;
}

double swellThatGains(const SpreadNodes& nodes, std::size_t n, double given) {
    double before = 0;
    for (std::size_t level = 0; level < nodes.gain.size(); ++level) {
        const auto gain = static_cast<double>(nodes.gain[level][n]);
        if (given <= gain && gain > before) {
            const double from = level == 0 ? 0 : TileSums::kSwells[level - 1];
            return std::min(std::lerp(from, TileSums::kSwells[level], (given - before) / (gain - before)), kMostSwell);
        }
        before = std::max(before, gain);
    }
    return given > 0 ? kMostSwell : 0;
}

}  // namespace stratum::voxelize
