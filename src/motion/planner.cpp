#include "motion/planner.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::motion {
namespace {

constexpr std::size_t kLookEvery = 256;  // pieces

double squared(double speed) { return speed * speed; }

}  // namespace

void Planner::move(const gcode::Move& move) {
    cutMove(move, limits_, [this](const Segment& segment) { add(segment); });
}

void Planner::add(const Segment& segment) {
    Pending next;
    next.segment = segment;
    next.gain = 2 * segment.acceleration * segment.length;
    const bool smooth = limits_.rule == gcode::CornerRule::corner_velocity;
    // Klipper has no such limit for moves of E alone.
    next.smooth_gain = smooth && segment.travels ? next.gain * (1 - limits_.cruise_ratio) : next.gain;
    next.peak_most = squared(segment.speed);
    if (at_rest_) {
        next.entry_most = next.smooth_most = squared(restSpeed(segment, limits_));
    } else {
        const Pending& before = pending_.back();
        const double corner = squared(cornerSpeed(before.segment, segment, limits_));
        next.entry_most = std::min(corner, before.entry_most + before.gain);
        next.smooth_most = std::min(corner, before.smooth_most + before.smooth_gain);
    }
    at_rest_ = false;
    smooth_ = smooth_ || smooth;
    pending_.push_back(next);
    if (pending_.size() - first_ < next_look_) return;
    std::size_t settled = lookBack(0);
    if (settled == 0 && pending_.size() - first_ >= kMostPending) settled = kMostPending / 2;
    if (settled > 0) settle(settled, pending_[first_ + settled].entry);
    // The next pass is when the number has doubled, so each segment is visited a few times at most.
    next_look_ = std::clamp(2 * (pending_.size() - first_), kLookEvery, kMostPending);
}

std::size_t Planner::lookBack(double exit_squared) {
    double entry = exit_squared;
    double smooth = exit_squared;
    std::size_t settled = 0;
    bool next_is_settled = false;
    for (std::size_t i = pending_.size(); i-- > first_;) {
        Pending& piece = pending_[i];
        const double next_smooth = smooth;
        const double smooth_reach = smooth + piece.smooth_gain;
        piece.entry = entry = std::min(piece.entry_most, entry + piece.gain);
        piece.smooth_entry = smooth = std::min(piece.smooth_most, smooth_reach);
        if (settled > 0) continue;
        // The segment itself stays pending, because its peak may still rise. With smoothed look-ahead the segments
        // before may share that peak, so it must be final: it is if the successor is final and the segment neither
        // decelerates nor accelerates over its whole length.
        const bool is_settled = entry == piece.entry_most && smooth == piece.smooth_most;
        const bool parts =
            !smooth_ || (next_is_settled && smooth < smooth_reach && smooth + piece.smooth_gain > next_smooth);
        if (is_settled && parts) settled = i - first_;
        next_is_settled = is_settled;
    }
    return settled;
}

// Klipper limits the peak between two slow corners to the speed that a lower acceleration reaches there, so that short
// zigzag moves cruise for a part of their length: decelerating segments share the peak of the segment in which
// deceleration begins, and so do the segments before it that only accelerate.
void Planner::smoothPeaks(std::size_t count) {
    braking_.clear();
    double peak = std::numeric_limits<double>::infinity();
    // One more segment, if there is one: it has the peak that those before it share.
    const std::size_t last = std::min(first_ + count + 1, pending_.size());
    for (std::size_t i = last; i-- > first_;) {
        Pending& piece = pending_[i];
        const double next = i + 1 < pending_.size() ? pending_[i + 1].smooth_entry : 0;
        const double reach = next + piece.smooth_gain;
        if (!(piece.smooth_entry < reach)) {
            braking_.push_back(i);
            continue;
        }
        if (piece.smooth_entry + piece.smooth_gain > next || !braking_.empty()) {
            peak = std::min(squared(piece.segment.speed), 0.5 * (piece.smooth_entry + reach));
            for (const std::size_t later : braking_)
                pending_[later].peak_most = std::min(pending_[later].peak_most, peak);
            braking_.clear();
        }
        piece.peak_most = std::min(squared(piece.segment.speed), peak);
    }
}

void Planner::settle(std::size_t count, double exit_squared) {
    if (smooth_) smoothPeaks(count);
    for (std::size_t i = first_; i < first_ + count; ++i) {
        const Pending& piece = pending_[i];
        double exit = i + 1 < first_ + count ? pending_[i + 1].entry : exit_squared;
        // By the jerk rules the next segment may begin with a discontinuous speed.
        exit = std::min(exit, squared(piece.segment.speed));
        PlannedPiece planned;
        planned.start = time_;
        planned.speed = fastest(piece.segment.length, piece.segment.acceleration, piece.entry, piece.peak_most, exit);
        planned.segment = piece.segment;
        sink_.piece(planned);
        time_ += planned.speed.seconds();
    }
    first_ += count;
    if (first_ < pending_.size() / 2) return;
    pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
}

void Planner::wait(double seconds) {
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
    at_rest_ = true;
    smooth_ = false;
    if (seconds > 0) sink_.wait(time_, seconds);
    time_ += seconds;
}

}  // namespace stratum::motion
