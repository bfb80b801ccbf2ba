// Look-ahead without a bound: the speeds that a pass over the whole program would give.
//
// A corner speed is final when no later segment can change it, that is, when it is the corner's limit even if the
// machine had to stop right after the last known segment. Only programs that decelerate over more than kMostPending
// consecutive segments are planned with a stop after so many.
// For the rules of firmwares whose own bounds are not modelled: Marlin 1.1's, the slicers' estimates, and
// RepRapFirmware 3's.
#pragma once

#include "motion/look_ahead.h"

#include <cstddef>
#include <vector>

namespace stratum::motion {

class ExactLookAhead : public LookAhead {
public:
    static constexpr std::size_t kMostPending = std::size_t{1} << 15;

    /// The sink must outlive it.
    explicit ExactLookAhead(SettledSink& sink) : sink_(sink) {}

    void add(const Segment& segment, const gcode::MachineLimits& limits) override;
    void stop() override;

private:
    // Speeds squared, mm^2/s^2.
    struct Pending {
        Segment segment;
        double entry_most = 0;  // limit of the corner and of acceleration since the last stop
        double gain = 0;        // 2 a d
        double entry = 0;
    };

    // Computes entry speeds for an end at this speed; returns how many segments at the front are final.
    std::size_t lookBack(double exit_squared);
    void settle(std::size_t count, double exit_squared);

    SettledSink& sink_;
    gcode::MachineLimits limits_;  // of the last segment
    std::vector<Pending> pending_;
    std::size_t first_ = 0;  // the first pending one; those before are final
    std::size_t next_look_ = 0;
};

}  // namespace stratum::motion
