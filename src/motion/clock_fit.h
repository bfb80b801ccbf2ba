// Acceleration and jerk of a machine that nobody names, from the times that the slicer wrote behind each layer.
//
// CuraEngine computes them by the limits of Cura's definition of the machine, which a program need not name
// (;TIME_ELAPSED). Layers differ in how much of their time is corners and short moves, so many of them tell
// acceleration and jerk apart. The first layers are kept until the fit, then they are planned as all others.
#pragma once

#include "gcode/printer/limit_origins.h"
#include "gcode/printer/motion.h"

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

namespace stratum::motion {

/// What explains the times of the layers.
struct FittedLimits {
    double acceleration = 0;  ///< mm/s^2
    double jerk = 0;          ///< mm/s, in the plane
};

/// Stands before a planner. Passes everything on unchanged, unless the limits are guessed (MachineLimits::guessed) for
/// CuraEngine's rule, no command states acceleration or jerk, and other values explain the layers' times: half of the
/// layers to 0.2 % or better, which the guess doesn't.
class ClockFit : public gcode::MotionSink {
public:
    /// The planner must outlive it.
    explicit ClockFit(gcode::MotionSink& planner) : planner_(planner) {}

    void limits(const gcode::MachineLimits& limits) override;
    void move(const gcode::Move& move) override;
    void wait(double seconds) override;
    void stop(gcode::Stop kind, std::uint32_t line) override;
    void elapsed(double seconds) override;
    void origin(const gcode::LimitOrigins& origins) override;
    /// End of the program: passes on what is still kept. Called once, before the planner's own end.
    void finish();

    const std::optional<FittedLimits>& fitted() const { return fitted_; }

private:
    struct Wait {
        double seconds;
    };
    struct Halt {
        gcode::Stop kind;
        std::uint32_t line;
    };
    struct Change {
        std::size_t limits;  // index into changes_
    };
    using Event = std::variant<gcode::Move, Wait, Halt, Change>;
    struct Layer {
        std::size_t begin;  // of its events
        std::size_t end;
        double seconds;  // as the slicer has it
    };

    void pass(const Event& event);
    void keep(const Event& event);
    gcode::MachineLimits corrected(gcode::MachineLimits limits) const;
    double plannedSeconds(const Layer& layer, const FittedLimits& limits) const;
    double misfit(const FittedLimits& limits) const;
    double medianError(const FittedLimits& limits) const;
    void fit();

    gcode::MotionSink& planner_;
    gcode::MachineLimits guess_;
    bool begun_ = false;
    bool keeping_ = false;
    std::optional<FittedLimits> fitted_;
    std::vector<Event> events_;
    std::vector<gcode::MachineLimits> changes_;
    std::vector<Layer> layers_;
    std::optional<double> clock_;  // s, at the last mark
    std::size_t marked_ = 0;       // events before it
};

}  // namespace stratum::motion
