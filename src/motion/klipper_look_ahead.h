// Klipper's queue of moves with its smoothed look-ahead.
//
// A second profile with the acceleration a (1 - minimum_cruise_ratio), the smoothed one, limits the highest speeds, so
// that short zigzag moves cruise for a part of their length. A segment that the smoothed profile can only decelerate
// has the cruise of the segment before it. Segments leave the queue as in Klipper: the queue is looked at each time
// when moves of 0.15 s (at full speed) were added, of 1 s after a stop, and what lies before the last two peaks is
// settled.
// Sources: Klipper of August 2026 (84104bbb), klippy/toolhead.py: Move, LookAheadQueue; klipper3d.org/Kinematics.html.
#pragma once

#include "motion/look_ahead.h"

#include <cstddef>
#include <vector>

namespace stratum::motion {

class KlipperLookAhead : public LookAhead {
public:
    /// The sink must outlive it.
    explicit KlipperLookAhead(SettledSink& sink);

    void add(const Segment& segment, const gcode::MachineLimits& limits) override;
    void stop() override;

private:
    // Speeds squared, mm^2/s^2.
    struct Queued {
        Segment segment;
        double deviation = 0;  // mm, of the corner at an acceleration of its own: as the limits were when it was made
        double gain = 0;       // 2 a d
        double smooth_gain = 0;
        double corner = 0;  // the most at its begin
        double smooth_corner = 0;
        double cruise_most = 0;
        // Set by look().
        double entry = 0;
        double cruise = 0;  // below zero: that of the segment before
    };

    void setCorner(const Queued& before, Queued& next, double extruder_jump) const;
    void look(bool all);
    void settle(std::size_t count);

    SettledSink& sink_;
    std::vector<Queued> queue_;
    std::size_t first_ = 0;  // those before are settled
    double until_look_;      // s of motion at full speed
    std::size_t crowd_ = 0;  // no look at fewer
};

}  // namespace stratum::motion
