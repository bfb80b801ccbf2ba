// How beads become plastic: the shape of their section, and whether overlapping beads fill the groove between them.
// docs/deposit.md has the mathematics and its sources.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

namespace stratum::gcode {

/// Of DepositModel::crown.
constexpr double kMostCrown = 0.5;

struct DepositModel {
    enum class Beads : std::uint8_t {
        capsule,  ///< the union of the beads
        grooves,  ///< what two neighbours of a layer both claim fills the groove between them
        settled,  ///< the same, and what the groove has no room for presses outlines out and raises tops
    };
    Beads beads = Beads::capsule;
    /// Corner radius of the section as a fraction of half its height, 0..1. 1 is a stadium. `corner_mm` takes
    /// precedence.
    double corner_fraction = 1;
    std::optional<double> corner_mm;  ///< the same in mm; half the height where that is less

    /// Seconds by which the flow out of the nozzle lags behind the extruder; none: every bead has its commanded width.
    std::optional<double> flow_lag;
    std::optional<double> pressure_advance;  ///< s; overrides the file's. Only with flow_lag
    double nozzle_diameter = 0.4;            ///< mm; the flow is averaged over it. Only with flow_lag
    /// How far a bead over nothing hangs down in the middle, as a fraction of the span.
    double sag = 0;
    /// How far the edges of a line on a top surface lie below its middle, as a fraction of the layer's height, 0 ..
    /// kMostCrown. Only with settled beads.
    double crown = 0;
    /// What oozes on travels through air becomes strings. Only with a flow_lag above 0.
    bool strings = false;

    /// Corner radius (mm) of a section of this height (mm).
    double cornerRadius(double height) const {
        return std::min(corner_mm.value_or(corner_fraction * 0.5 * height), 0.5 * height);
    }
    bool settles() const { return beads != Beads::capsule; }
    bool swells() const { return beads == Beads::settled; }
    /// For every height.
    bool stadium() const { return !corner_mm && corner_fraction == 1; }
};

/// "settled, corners of 50 % of half the height"; "capsule, stadium" is the default.
std::string describe(const DepositModel& deposit);

}  // namespace stratum::gcode
