#include "motion/marlin_look_ahead.h"

#include "motion/corner.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::motion {
namespace {

using gcode::kMotionAxes;
using gcode::MachineLimits;

constexpr double kLeastSteps = 6;       // MIN_STEPS_PER_SEGMENT
constexpr double kLeastRate = 120;      // steps/s: MINIMAL_STEP_RATE
constexpr double kStraight = 0.999999;  // cosine beyond which two directions are one

double norm(const std::array<double, kMotionAxes>& v, std::size_t axes) {
    double sum = 0;
    for (std::size_t axis = 0; axis < axes; ++axis) sum += v[axis] * v[axis];
    return std::sqrt(sum);
}

// All four must be known.
bool countsSteps(const MachineLimits& limits) {
    return std::all_of(limits.steps_per_mm.begin(), limits.steps_per_mm.end(), [](double steps) { return steps > 0; });
}

// The largest acceleration along a direction (of any length) within the limits of all axes.
double accelerationAlong(const std::array<double, kMotionAxes>& direction, double norm, double acceleration,
                         const MachineLimits& limits) {
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        const double share = std::abs(direction[axis]);
        if (share * acceleration > limits.acceleration[axis] * norm)
            acceleration = limits.acceleration[axis] * norm / share;
    }
    return acceleration;
}

// acos(t) for t in (0, 1] by straight lines between the points 1 - 2^-k, as Marlin's table has it: raised by 0.75 % to
// share the error between both signs, except at both ends.
double roughArcCosine(double t) {
    constexpr int kPieces = 16;
    struct Node {
        double x;
        double y;
    };
    static const auto nodes = [] {
        std::array<Node, kPieces + 1> made{};
        for (int k = 0; k < kPieces; ++k) made[k].x = 1 - std::ldexp(1, -k);
        made[kPieces].x = kStraight;
        for (int k = 0; k <= kPieces; ++k) made[k].y = std::acos(made[k].x) * (k % kPieces == 0 ? 1 : 1.00751495);
        return made;
    }();
    const int piece = t >= 1 ? kPieces - 1 : std::clamp(-std::ilogb(1 - t) - 1, 0, kPieces - 1);
    const Node& from = nodes[piece];
    const Node& to = nodes[piece + 1];
    return from.y + (t - from.x) * (to.y - from.y) / (to.x - from.x);
}

}  // namespace

Trapezoid MarlinBlock::between(double entry_squared, double exit_squared) const {
    const double most = squared(speed);
    const double entry = std::min(entry_squared, most);
    const double exit = std::min(exit_squared, most);
    return steps > 0 ? inSteps(entry, exit) : fastest(length, acceleration, entry, most, exit);
}

Trapezoid MarlinBlock::inSteps(double entry_squared, double exit_squared) const {
    const double mm = length / steps;
    const double twice = 2 * acceleration / mm;  // steps/s^2
    const auto rateAt = [&](double speed_squared) {
        return std::min(std::max(std::ceil(rate * std::sqrt(speed_squared) / speed), kLeastRate), rate);
    };
    const double first = squared(rateAt(entry_squared));
    // Whole steps up and down: up a part of one more, down a part of one less.
    const double up = (squared(rate) - first) / twice;
    const double down = (squared(rate) - squared(rateAt(exit_squared))) / twice;
    double rising = std::ceil(up);
    double falling = std::floor(down);
    if (rising + falling > steps) {
        rising = std::clamp(std::ceil(0.5 * (steps + up - down)), 0.0, steps);
        falling = steps - rising;
    }
    const double peak = std::min(squared(rate), first + twice * rising);
    const double last = std::max(peak - twice * falling, 0.0);
    return throughPeak(length, acceleration, first * mm * mm, peak * mm * mm, last * mm * mm);
}

bool MarlinBlocks::roundToSteps(const Segment& segment, const MachineLimits& limits, Axes& way, Axes& steps) {
    if (!countsSteps(limits)) {
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis)
            way[axis] = steps[axis] = segment.length * segment.direction[axis];
        return true;
    }
    if (limits.steps_per_mm != steps_per_mm_) {  // M92
        steps_per_mm_ = limits.steps_per_mm;
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis)
            at_[axis] = std::llround(target_[axis] * steps_per_mm_[axis]);
    }
    std::array<std::int64_t, kMotionAxes> to{};
    double most = 0;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        target_[axis] += segment.length * segment.direction[axis];
        to[axis] = std::llround(target_[axis] * limits.steps_per_mm[axis]);
        steps[axis] = static_cast<double>(to[axis] - at_[axis]);
        way[axis] = steps[axis] / limits.steps_per_mm[axis];
        most = std::max(most, std::abs(steps[axis]));
    }
    if (most < kLeastSteps) return false;
    at_ = to;
    return true;
}

std::optional<MarlinBlock> MarlinBlocks::next(const Segment& segment, const MachineLimits& limits, bool at_rest) {
    Axes way{};
    Axes steps{};
    if (!roundToSteps(segment, limits, way, steps)) return std::nullopt;
    const bool counts = countsSteps(limits);
    MarlinBlock block;
    double most_steps = 0;
    double most_path = 0;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        most_steps = std::max(most_steps, std::abs(steps[axis]));
        if (axis < 3) most_path = std::max(most_path, std::abs(steps[axis]));
    }
    // Some steps of x, y and z beside more of E count for nothing.
    const bool travels = counts ? most_path >= kLeastSteps : segment.travels;
    block.length = travels ? norm(way, 3) : std::abs(way[3]);
    const bool extrudes = steps[3] != 0;
    const double asked = std::max(segment.asked, extrudes ? limits.least_printing_speed : limits.least_travel_speed);
    double factor = 1;
    Axes velocity{};
    const double per_second = asked / block.length;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        velocity[axis] = way[axis] * per_second;
        const double speed = std::abs(velocity[axis]);
        if (speed > limits.speed[axis]) factor = std::min(factor, limits.speed[axis] / speed);
    }
    for (double& v : velocity) v *= factor;
    block.speed = asked * factor;
    block.acceleration = most_path == 0 ? limits.retracting : extrudes ? limits.printing : limits.travel;
    const double per_mm = most_steps / block.length;
    if (counts) block.acceleration = std::ceil(block.acceleration * per_mm) / per_mm;
    if (most_path > 0) block.acceleration = accelerationAlong(way, block.length, block.acceleration, limits);
    if (counts) {
        block.steps = most_steps;
        block.rate = std::max(std::floor(std::ceil(asked * per_mm) * factor), 1.0);
        block.acceleration = std::max(std::floor(block.acceleration * per_mm + 1e-6), 1.0) / per_mm;
    }
    block.last_exit = squared(kMarlinLeastSpeed);
    if (segment.arc_rest > 0) {
        const double weaker = std::min(limits.acceleration[0], limits.acceleration[1]);
        const double slower = std::min({limits.speed[0], limits.speed[1], asked});
        block.last_exit = std::max(block.last_exit,
                                   std::min({squared(slower), weaker * segment.radius, 2 * weaker * segment.arc_rest}));
    }
    if (limits.rule == gcode::CornerRule::marlin_jerk)
        limitJerk(limits, velocity, at_rest, block);
    else
        limitJunction(segment, limits, way, at_rest, block);
    velocity_before_ = velocity;
    speed_before_ = block.speed;
    return block;
}

void MarlinBlocks::limitJunction(const Segment& segment, const MachineLimits& limits, const Axes& way, bool at_rest,
                                 MarlinBlock& block) {
    Axes unit = way;
    const double inverse = 1 / (way[3] != 0 ? norm(way, kMotionAxes) : block.length);
    double cosine = 0;  // of the angle inside the corner
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        unit[axis] *= inverse;
        cosine -= unit_before_[axis] * unit[axis];
    }
    // Within an arc, but not at its end.
    const double radius = segment.arc_rest > 0 ? radius_before_ : 0;
    radius_before_ = segment.arc_rest > 0 ? segment.radius : 0;
    Axes across{};
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) across[axis] = unit[axis] - unit_before_[axis];
    unit_before_ = unit;
    if (at_rest) return;
    double squared_speed = squared(kMarlinLeastSpeed);
    if (cosine <= kStraight) {
        const double acceleration = accelerationAlong(across, norm(across, kMotionAxes), block.acceleration, limits);
        if (radius > 0) {
            squared_speed = acceleration * radius;
        } else {
            cosine = std::max(cosine, -kStraight);
            const double sine = std::sqrt(0.5 * (1 - cosine));  // of half the angle
            squared_speed = acceleration * limits.junction_deviation * sine / (1 - sine);
            // Short segments of a curve: the limit of their circle.
            if (block.length < 1 && cosine < -std::numbers::sqrt2 / 2)
                squared_speed = std::min(squared_speed, block.length * acceleration / roughArcCosine(-cosine));
        }
    }
    block.entry_most = std::min({squared_speed, squared(block.speed), squared(speed_before_)});
}

void MarlinBlocks::limitJerk(const MachineLimits& limits, const Axes& velocity, bool at_rest, MarlinBlock& block) {
    // The speed from which the machine may stop at once.
    double safe = block.speed;
    for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
        const double jump = std::abs(velocity[axis]);
        if (jump > limits.jerk[axis]) safe = std::min(safe, block.speed * limits.jerk[axis] / jump);
    }
    double most = safe;
    if (!at_rest) {
        most = std::min(block.speed, speed_before_);
        const double slower = std::min(1.0, block.speed / speed_before_);
        double factor = 1;
        for (std::size_t axis = 0; axis < kMotionAxes; ++axis) {
            const double jump = axisJump(velocity_before_[axis] * slower * factor, velocity[axis] * factor);
            if (jump > limits.jerk[axis]) factor *= limits.jerk[axis] / jump;
        }
        most *= factor;
        // A stop and a new start may be faster than the corner.
        if (safe_before_ > 0.99 * most && safe > 0.99 * most) most = safe;
    }
    safe_before_ = safe;
    block.entry_most = squared(most);
}

namespace {

constexpr std::size_t kQueued = 14;  // of 16 places: one is kept empty, and one is taken only when a block has left

}  // namespace

void MarlinLookAhead::add(const Segment& segment, const gcode::MachineLimits& limits) {
    const auto block = blocks_.next(segment, limits, count_ == 0);
    if (!block) {
        short_.push_back(segment);
        ++waiting_;
        return;
    }
    if (count_ == 0) entry_ = block->entry_most;
    Queued& last = at(count_);
    last.block = *block;
    last.segment = segment;
    last.merged = waiting_;
    waiting_ = 0;
    if (++count_ > kQueued) settleFirst();
}

double MarlinLookAhead::secondEntry() {
    // No more than the first block can reach, no more than allows to meet all later corners and the end.
    double most = entry_ + at(0).block.gain();
    double gains = 0;
    for (std::size_t i = 1; i < count_ && gains < most; ++i) {
        most = std::min(most, at(i).block.entry_most + gains);
        gains += at(i).block.gain();
    }
    return std::min(most, at(count_ - 1).block.last_exit + gains);
}

void MarlinLookAhead::settleFirst() {
    Queued& now = at(0);
    const double exit = count_ > 1 ? secondEntry() : now.block.last_exit;
    const Trapezoid profile = now.block.between(entry_, exit);
    now.segment.speed = std::max(now.block.speed, profile.peak);  // rates are whole steps a second
    now.segment.acceleration = now.block.acceleration;
    if (now.merged > 0) {
        settleMerged(now, profile);
    } else {
        now.segment.length = now.block.length;
        sink_.settled(now.segment, profile);
    }
    entry_ = exit;
    first_ = (first_ + 1) % queue_.size();
    --count_;
}

void MarlinLookAhead::settleMerged(const Queued& now, const Trapezoid& profile) {
    // Each has its share of the block.
    const auto last = short_.begin() + static_cast<std::ptrdiff_t>(now.merged);
    double whole = now.segment.length;
    for (auto segment = short_.begin(); segment != last; ++segment) whole += segment->length;
    double from = 0;
    const auto settle = [&](Segment segment) {
        segment.speed = std::max(now.block.speed, profile.peak);
        segment.acceleration = now.block.acceleration;
        segment.length *= now.block.length / whole;
        const double to = from + segment.length;
        sink_.settled(segment, partOf(profile, from, to));
        from = to;
    };
    std::for_each(short_.begin(), last, settle);
    settle(now.segment);
    short_.erase(short_.begin(), last);
}

void MarlinLookAhead::stop() {
    while (count_ > 0) settleFirst();
}

}  // namespace stratum::motion
