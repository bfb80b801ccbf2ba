// A firmware's motion planner: computes the speed at every moment from the moves of a program.
#pragma once

#include "gcode/printer/motion.h"
#include "motion/look_ahead.h"
#include "motion/segment.h"
#include "motion/trapezoid.h"

#include <memory>

namespace stratum::motion {

/// A segment of motion with its speeds and its time, from which flow and times are computed.
struct PlannedPiece {
    double start = 0;  ///< s since the program's begin
    Trapezoid speed;
    Segment segment;
};

/// Receives the plan, in order, one segment at a time.
class PlanSink {
public:
    PlanSink() = default;
    PlanSink(const PlanSink&) = delete;
    PlanSink& operator=(const PlanSink&) = delete;
    virtual ~PlanSink() = default;

    virtual void piece(const PlannedPiece& piece) = 0;
    /// The machine waits from `start` on for `seconds`.
    virtual void wait(double start, double seconds) = 0;
};

class Planner : public gcode::MotionSink, private SettledSink {
public:
    /// The sink must outlive the planner.
    explicit Planner(PlanSink& sink);

    /// A rule of another firmware stops the machine first.
    void limits(const gcode::MachineLimits& limits) override;
    void move(const gcode::Move& move) override;
    void wait(double seconds) override;
    /// End of the program: plans the remaining segments. Called once.
    void finish() { wait(0); }

    double seconds() const { return time_; }
    /// The rule at the end of the program.
    gcode::CornerRule rule() const { return limits_.rule; }

private:
    void settled(const Segment& segment, const Trapezoid& speed) override;

    PlanSink& sink_;
    gcode::MachineLimits limits_;
    std::unique_ptr<LookAhead> look_ahead_;
    double time_ = 0;
};

}  // namespace stratum::motion
