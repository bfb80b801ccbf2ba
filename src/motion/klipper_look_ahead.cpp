#include "motion/klipper_look_ahead.h"

#include "motion/axis_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::motion {
namespace {

// Beyond this many the queue is looked at only when it has grown by a quarter: the work stays in proportion to the
// program. No machine has that many: they would all have to be within one braking distance.
constexpr std::size_t kCrowd = std::size_t{1} << 14;
constexpr double kAfterStop = 1;        // s of motion before the first look
constexpr double kBetweenLooks = 0.15;  // s

}  // namespace

KlipperLookAhead::KlipperLookAhead(SettledSink& sink) : sink_(sink), until_look_(kAfterStop) {}

void KlipperLookAhead::setCorner(const Queued& before, Queued& next, double extruder_jump) const {
    // Moves of E alone begin and end at rest.
    if (!before.segment.travels || !next.segment.travels) return;
    const auto& from = before.segment.direction;
    const auto& to = next.segment.direction;
    double most = std::min({next.cruise_most, before.cruise_most, before.corner + before.gain});
    if (const double jump = std::abs(to[3] - from[3]); jump > 0) most = std::min(most, squared(extruder_jump / jump));
    const double cosine = from[0] * to[0] + from[1] * to[1] + from[2] * to[2];  // of the change of direction
    const double sine_half = std::sqrt(std::max(0.5 * (1 + cosine), 0.0));      // of half the angle inside the corner
    const double cosine_half = std::sqrt(std::max(0.5 * (1 - cosine), 0.0));
    if (sine_half < 1 && cosine_half > 0) {
        const double radii = sine_half / (1 - sine_half);  // of the circle, in deviations
        const double quarter_tangent = 0.25 * sine_half / cosine_half;
        most = std::min({most, radii * next.deviation * next.segment.acceleration,
                         radii * before.deviation * before.segment.acceleration, next.gain * quarter_tangent,
                         before.gain * quarter_tangent});
    }
    next.corner = most;
    next.smooth_corner = std::min(most, before.smooth_corner + before.smooth_gain);
}

void KlipperLookAhead::add(const Segment& segment, const gcode::MachineLimits& limits) {
    Queued next;
    next.segment = segment;
    limitByAxes(limits, next.segment);
    const double most = limits.printing;
    next.deviation = squared(limits.corner_velocity) * (std::numbers::sqrt2 - 1) / most;
    next.cruise_most = squared(next.segment.speed);
    next.gain = 2 * segment.length * next.segment.acceleration;
    next.smooth_gain = std::min(2 * segment.length * most * (1 - limits.cruise_ratio), next.gain);
    const double shortest = segment.length / next.segment.speed;  // s
    if (first_ == queue_.size()) {
        queue_.push_back(next);
        return;
    }
    setCorner(queue_.back(), next, limits.extruder_corner_velocity);
    queue_.push_back(next);
    until_look_ -= shortest;
    if (until_look_ <= 0 && queue_.size() - first_ >= crowd_) look(false);
}

void KlipperLookAhead::stop() {
    look(true);
    until_look_ = kAfterStop;
}

void KlipperLookAhead::look(bool all) {
    until_look_ = kBetweenLooks;
    double entry = 0;  // of the segment after; the machine stops after the last one
    double smooth_entry = 0;
    double peak = 0;
    std::size_t waiting = 0;  // segments whose cruise follows from one before them
    std::size_t settled = all ? queue_.size() - first_ : 0;
    for (std::size_t i = queue_.size(); i-- > first_;) {
        Queued& move = queue_[i];
        const double reach = entry + move.gain;
        const double start = std::min(move.corner, reach);
        const double smooth_reach = smooth_entry + move.smooth_gain;
        const double smooth_start = std::min(move.smooth_corner, smooth_reach);
        ++waiting;
        move.entry = start;
        move.cruise = -1;
        if (smooth_start < smooth_reach) {
            // It may accelerate. It has a peak of its own if it may decelerate too, or if those after it only
            // decelerate.
            if (smooth_start + move.smooth_gain > smooth_entry || waiting > 1) {
                if (settled == 0 && peak > 0) settled = i - first_ + waiting;
                peak = 0.5 * (smooth_start + smooth_reach);
            }
            move.cruise = std::min({0.5 * (start + reach), move.cruise_most, peak});
            waiting = 0;
        }
        entry = start;
        smooth_entry = smooth_start;
    }
    settle(settled);
    const std::size_t left = queue_.size() - first_;
    crowd_ = left < kCrowd ? 0 : left + left / 4;
}

void KlipperLookAhead::settle(std::size_t count) {
    double cruise_before = 0;
    for (std::size_t i = first_; i < first_ + count; ++i) {
        Queued& move = queue_[i];
        const double next_entry = i + 1 < queue_.size() ? queue_[i + 1].entry : 0;
        const double cruise = move.cruise < 0 ? std::min(cruise_before, move.entry) : move.cruise;
        cruise_before = cruise;
        sink_.settled(move.segment, throughPeak(move.segment.length, move.segment.acceleration,
                                                std::min(move.entry, cruise), cruise, std::min(next_entry, cruise)));
    }
    first_ += count;
    if (first_ < queue_.size() / 2) return;
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(first_));
    first_ = 0;
}

}  // namespace stratum::motion
