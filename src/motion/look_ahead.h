// Finds the speeds at the corners of a stream of segments: one class for each way in which firmwares look ahead.
#pragma once

#include "gcode/printer/motion.h"
#include "motion/segment.h"
#include "motion/trapezoid.h"

#include <memory>

namespace stratum::motion {

/// Receives segments whose speeds are final, in order.
class SettledSink {
public:
    SettledSink() = default;
    SettledSink(const SettledSink&) = delete;
    SettledSink& operator=(const SettledSink&) = delete;
    virtual ~SettledSink() = default;

    virtual void settled(const Segment& segment, const Trapezoid& speed) = 0;
};

class LookAhead {
public:
    LookAhead() = default;
    LookAhead(const LookAhead&) = delete;
    LookAhead& operator=(const LookAhead&) = delete;
    virtual ~LookAhead() = default;

    /// The next segment as cutMove() gives it, and the limits in force.
    virtual void add(const Segment& segment, const gcode::MachineLimits& limits) = 0;
    /// The machine stops after the last segment: settles all.
    virtual void stop() = 0;
};

/// The look-ahead of a rule's firmware. The sink must outlive it.
std::unique_ptr<LookAhead> makeLookAhead(gcode::CornerRule rule, SettledSink& sink);

/// Whether two rules look ahead in the same way, so that the rule may change without a stop.
bool looksAheadAlike(gcode::CornerRule a, gcode::CornerRule b);

}  // namespace stratum::motion
