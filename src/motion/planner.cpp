#include "motion/planner.h"

namespace stratum::motion {

Planner::Planner(PlanSink& sink) : sink_(sink), look_ahead_(makeLookAhead(limits_.rule, *this)) {}

void Planner::limits(const gcode::MachineLimits& limits) {
    if (!looksAheadAlike(limits.rule, limits_.rule)) {
        look_ahead_->stop();
        look_ahead_ = makeLookAhead(limits.rule, *this);
    }
    limits_ = limits;
}

void Planner::move(const gcode::Move& move) {
    cutMove(move, limits_, [this](const Segment& segment) { look_ahead_->add(segment, limits_); });
}

void Planner::settled(const Segment& segment, const Trapezoid& speed) {
    sink_.piece({.start = time_, .speed = speed, .segment = segment});
    time_ += speed.seconds();
}

void Planner::wait(double seconds) {
    look_ahead_->stop();
    if (seconds > 0) sink_.wait(time_, seconds);
    time_ += seconds;
}

}  // namespace stratum::motion
