// Computes from the planned motion what flows out of the nozzle, and where.
//
// The extruder presses filament into the nozzle: E(t), as a volume. Pressure advance K adds K dE/dt while it prints.
// What is pressed in and has not flowed out is pressure, and the flow is proportional to it:
//     T dV/dt = E + K dE/dt - V    while that is positive, else dV/dt = 0
// A retraction draws the plastic back: the flow stops at once, and starts again when the extruder is back where it was.
// On each phase of a trapezoid dE/dt = a + b t, so the flow is, in closed form,
//     Q(t) = a' + b (t - T) + (Q0 - a' + b T) exp(-t / T),   a' = a + K b,   V = E + K dE/dt - T Q.
// Nothing is lost: what is laid and what is in the nozzle is what was fed.
//
// Sources: klipper3d.org/Kinematics.html, "Pressure advance", for the extruder's rule; P. Tronvoll et al.,
// "Investigating pressure advance algorithms for filament-based melt extrusion additive manufacturing" (2019), for the
// lag of first order.
#pragma once

#include "deposit/flow_record.h"
#include "deposit/string_recorder.h"
#include "motion/planner.h"

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace stratum::deposit {

// The flow along an unbroken path: averaged over the width of the nozzle, and divided into parts of linear section.

/// A part's section is within this of the averaged one, as a fraction of the commanded section.
constexpr double kSectionTolerance = 0.02;

/// A sample of the flow: what is laid between two places of a bead.
struct FlowInterval {
    std::uint32_t bead = 0;
    bool tapers = false;    ///< a straight level bead, whose section may change along a part
    double s0 = 0, s1 = 0;  ///< mm along the bead
    double commanded = 0;   ///< mm^2, the section that the program states
    double volume = 0;      ///< mm^3
    double t0 = 0, t1 = 0;  ///< s
};

/// What flows out at rest before interval `before` of a path, or at its end.
struct PathSpot {
    std::size_t before = 0;
    double volume = 0;  ///< mm^3
    double time = 0;    ///< s
};

/// Appends the parts and spots of a path, which is not empty. Spots of little volume become part of the path beside
/// them. Spots are ascending. A closed path ends where it begins. The flow is averaged over at least `least` mm of the
/// path, the width of the nozzle, for so long each place lies under its opening: without that a stop of no length would
/// have an infinite section.
void dividePath(std::span<const FlowInterval> path, std::span<const PathSpot> spots, bool closed, double least,
                FlowRecord& record);

/// Beads that follow each other without a travel are one path. What flows out on a travel is laid where the travel
/// begins, or becomes strings (string_recorder.h) if asked for. What flows out after it, before the nozzle prints, is
/// laid where the next path begins; what flows out before another travel is purged.
class FlowRecorder : public motion::PlanSink {
public:
    /// Seconds, >= 0. `advance` overrides that of the file. `nozzle`: mm, > 0.
    FlowRecorder(double lag, std::optional<double> advance, double nozzle, bool strings = false)
        : lag_(lag), advance_(advance), nozzle_(nozzle) {
        if (strings) strings_.emplace();
    }

    void piece(const motion::PlannedPiece& piece) override;
    void wait(double start, double seconds) override;
    /// The record, at the end of the program. Called once.
    FlowRecord finish();

private:
    // Commanded flow a + b t (mm^3/s) for t from 0 to `seconds`.
    struct Phase {
        double start, seconds, a, b;
        double v0, v1;  // mm/s along the path
        bool prints;
        double along = 0;  // mm of the segment at its start
    };
    void runPhase(const Phase& phase, const motion::Segment& segment);
    void layPhase(const Phase& phase, const motion::Segment& segment);
    /// What the extruder has pressed in at t, its advance included, mm^3.
    double pressed(const Phase& phase, double t) const;
    /// The flow at `to`, of a phase with the pressure `pressure` (mm^3) at `from`.
    double flowAt(const Phase& phase, double from, double pressure, double to) const;
    /// Goes on from one time of a phase to another; returns what flows out.
    double flowOut(const Phase& phase, double from, double to);
    void ooze(const Phase& phase, const motion::Segment& segment);
    void layAtEnd(double volume, double time);
    void endTravel(double time);
    void rest(double volume, bool in_plane, double time);
    void endPath();

    const double lag_;
    const std::optional<double> advance_;
    const double nozzle_;             // mm, its width: the flow is averaged over that much of the path
    double advance_now_ = 0;          // s
    double fed_ = 0;                  // mm^3, E at the begin of a phase
    double along_ = 0;                // mm, on the last bead of path_
    double path_x_ = 0, path_y_ = 0;  // mm, from the begin of path_ to its end
    std::vector<FlowInterval> path_;
    std::vector<PathSpot> spots_;
    bool travelled_ = true;  // since the end of path_
    PathSpot arrival_;       // before the next path
    std::optional<StringRecorder> strings_;
    std::size_t moves_ = 0;  // segments up to now
    FlowRecord record_;
};

}  // namespace stratum::deposit
