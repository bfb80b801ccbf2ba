// Marlin 2's queue of 16 blocks: a corner's speed is final when the block before it begins to move.
// Sources: Marlin 2.1.2.5, Marlin/src/module/planner.cpp (reverse_pass, forward_pass, get_current_block); the host is
// taken to be never late, so that the queue is full until the machine has to stop.
#pragma once

#include "gcode/printer/motion.h"
#include "motion/look_ahead.h"
#include "motion/segment.h"
#include "motion/trapezoid.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace stratum::motion {

// A block of Marlin 2's planner: a segment in whole steps, with the limits of its axes and of the corner before it.
//
// Where the steps per mm are known, ends of segments are rounded to steps, segments below 6 steps on all axes are
// merged with the next one, rates are whole steps per second, and no block begins or ends below 120 of them. Sources:
// Marlin 2.1.2.5, Marlin/src/module/planner.cpp (_populate_block, calculate_trapezoid_for_block), its default
// configuration; S. K. Jeon, "Improving Grbl's cornering algorithm" (2011) for junction deviation.

/// mm/s. Marlin plans no corner and no end slower than this.
constexpr double kMarlinLeastSpeed = 0.05;

struct MarlinBlock {
    double length = 0;        ///< mm
    double speed = 0;         ///< mm/s, within the limits
    double acceleration = 0;  ///< mm/s^2, within the limits
    double steps = 0;         ///< of the axis with most of them; 0: steps are not counted
    double rate = 0;          ///< steps/s at full speed
    double entry_most = 0;    ///< (mm/s)^2 at its begin
    double last_exit = 0;     ///< (mm/s)^2 with which it may end while it is the last one: higher within arcs

    double gain() const { return 2 * acceleration * length; }
    /// Its profile between two speeds, squared.
    Trapezoid between(double entry_squared, double exit_squared) const;

private:
    Trapezoid inSteps(double entry_squared, double exit_squared) const;
};

class MarlinBlocks {
public:
    /// The block of a segment, nullopt if it is too short and waits for the next one. `at_rest`: nothing moves before.
    std::optional<MarlinBlock> next(const Segment& segment, const gcode::MachineLimits& limits, bool at_rest);

private:
    using Axes = std::array<double, gcode::kMotionAxes>;

    bool roundToSteps(const Segment& segment, const gcode::MachineLimits& limits, Axes& way, Axes& steps);
    void limitJunction(const Segment& segment, const gcode::MachineLimits& limits, const Axes& way, bool at_rest,
                       MarlinBlock& block);
    void limitJerk(const gcode::MachineLimits& limits, const Axes& velocity, bool at_rest, MarlinBlock& block);

    Axes target_{};                                      // mm since the begin
    std::array<std::int64_t, gcode::kMotionAxes> at_{};  // steps since the begin
    Axes steps_per_mm_{};                                // in force; 0: not yet known
    // Of the block before.
    Axes unit_before_{};
    Axes velocity_before_{};  // mm/s
    double speed_before_ = 0;
    double safe_before_ = 0;
    double radius_before_ = 0;
};

class MarlinLookAhead : public LookAhead {
public:
    /// The sink must outlive it.
    explicit MarlinLookAhead(SettledSink& sink) : sink_(sink) {}

    void add(const Segment& segment, const gcode::MachineLimits& limits) override;
    void stop() override;

private:
    struct Queued {
        MarlinBlock block;
        Segment segment;
        std::size_t merged = 0;  // short segments that were merged into it
    };

    Queued& at(std::size_t place) { return queue_[(first_ + place) % queue_.size()]; }
    /// The speed, squared, at the begin of the second block, by what is known.
    double secondEntry();
    void settleFirst();
    void settleMerged(const Queued& now, const Trapezoid& profile);

    SettledSink& sink_;
    MarlinBlocks blocks_;
    std::vector<Segment> short_;  // those merged into blocks of the queue, then those that wait for a block
    std::size_t waiting_ = 0;     // of these
    std::array<Queued, 16> queue_;
    std::size_t first_ = 0;
    std::size_t count_ = 0;
    double entry_ = 0;  // of the first block, squared: final
};

}  // namespace stratum::motion
