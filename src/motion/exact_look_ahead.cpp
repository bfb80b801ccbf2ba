#include "motion/exact_look_ahead.h"

#include "motion/axis_limits.h"
#include "motion/corner.h"

#include <algorithm>

namespace stratum::motion {
namespace {

constexpr std::size_t kLookEvery = 256;  // segments

}  // namespace

void ExactLookAhead::add(const Segment& segment, const gcode::MachineLimits& limits) {
    limits_ = limits;
    Pending next;
    next.segment = segment;
    if (limits.rule == gcode::CornerRule::bambu_jerk)
        next.segment.speed = std::min(
            next.segment.speed, curveSpeed(pending_.empty() ? nullptr : &pending_.back().segment, segment, limits));
    limitByAxes(limits, next.segment);
    next.gain = 2 * next.segment.acceleration * next.segment.length;
    if (pending_.empty()) {
        next.entry_most = squared(restSpeed(next.segment, limits));
    } else {
        const Pending& before = pending_.back();
        const double corner = squared(cornerSpeed(before.segment, next.segment, limits));
        next.entry_most = std::min(corner, before.entry_most + before.gain);
    }
    pending_.push_back(next);
    if (pending_.size() - first_ < next_look_) return;
    std::size_t settled = lookBack(0);
    if (settled == 0 && pending_.size() - first_ >= kMostPending) settled = kMostPending / 2;
    if (settled > 0) settle(settled, pending_[first_ + settled].entry);
    // The next pass is when the number has doubled, so each segment is visited a few times at most.
    next_look_ = std::clamp(2 * (pending_.size() - first_), kLookEvery, kMostPending);
}

std::size_t ExactLookAhead::lookBack(double exit_squared) {
    double entry = exit_squared;
    std::size_t settled = 0;
    for (std::size_t i = pending_.size(); i-- > first_;) {
        Pending& piece = pending_[i];
        piece.entry = entry = std::min(piece.entry_most, entry + piece.gain);
        // The segment itself stays pending, because its peak may still rise.
        if (settled == 0 && entry == piece.entry_most) settled = i - first_;
    }
    return settled;
}

void ExactLookAhead::settle(std::size_t count, double exit_squared) {
    for (std::size_t i = first_; i < first_ + count; ++i) {
        const Pending& piece = pending_[i];
        const Segment& segment = piece.segment;
        // By the jerk rules the next segment may begin with a discontinuous speed.
        const double most = squared(segment.speed);
        const double exit = std::min(i + 1 < first_ + count ? pending_[i + 1].entry : exit_squared, most);
        sink_.settled(segment, fastest(segment.length, segment.acceleration, piece.entry, most, exit));
    }
    first_ += count;
    if (first_ < pending_.size() / 2) return;
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
}

void ExactLookAhead::stop() {
    if (first_ < pending_.size()) {
        // The allowed change of speed at a stop doesn't raise the limits before it.
        const Pending& last = pending_.back();
        const double exit = std::min(squared(restSpeed(last.segment, limits_)), last.entry_most + last.gain);
        lookBack(exit);
        settle(pending_.size() - first_, exit);
    }
    pending_.clear();
    first_ = 0;
    next_look_ = kLookEvery;
}

}  // namespace stratum::motion
