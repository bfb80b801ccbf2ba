// The seam between reading G-code and everything after it: beads as plain data.
//
// Print space: millimetres, x and y in the bed plane, z up, as the G-code has them; of a belt printer in the plane of
// its gantry, z across it. One bead is one extruding move.
// Sources: Marlin G0-G3 (marlinfw.org/docs/gcode), Slic3r's flow math for the stadium cross-section.
#pragma once

#include "gcode/toolpath/color.h"
#include "gcode/toolpath/packed_double.h"
#include "gcode/toolpath/stated.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

// How beads become plastic: the shape of their section, and whether overlapping beads fill the groove between them.
// docs/deposit.md has the mathematics and its sources.

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

/// The extrusion role of a bead, common to all slicers. Names as in featureName().
enum class Feature : std::uint8_t {
    unknown,
    perimeter,
    external_perimeter,
    overhang_perimeter,
    infill,
    solid_infill,
    top_infill,
    bridge,
    gap_fill,
    ironing,
    skirt,
    brim,
    support,
    support_interface,
    wipe_tower,
    custom,
    count_
};
constexpr std::size_t kFeatureCount = static_cast<std::size_t>(Feature::count_);

/// Lower-case name with dashes, e.g. "external-perimeter".
std::string_view featureName(Feature feature);
/// The feature of that name, or Feature::count_ if there is none.
Feature featureNamed(std::string_view name);

/// A circular plan path. The path starts at the bead's start, turns by `sweep` radians (counter-clockwise positive,
/// |sweep| <= 2 pi) about the center, with z linear in the angle. Its radius is the mean of the distances of start and
/// end from the center, so that a file's rounding (a micrometre) is shared by both ends.
struct Arc {
    double center_x = 0;     ///< mm
    double center_y = 0;     ///< mm
    double sweep = 0;        ///< radians
    std::uint32_t line = 0;  ///< 1-based line in the source
};

/// One extruding move. Coordinates are of the nozzle: z is the top of the bead. Large prints have millions of them, so
/// there is no padding.
struct Bead {
    PackedDouble x0{}, y0{}, z0{};  ///< mm, start
    PackedDouble x1{}, y1{}, z1{};  ///< mm, end
    float width = 0;                ///< mm; width >= height: stadium section; width < height: round, of this diameter
    std::uint32_t run = 0;          ///< index into Toolpath::runs
    std::int32_t arc = -1;          ///< >= 0: index into Toolpath::arcs; < 0: straight, minus its line in the source
};
static_assert(sizeof(Bead) == 60);

/// Properties that consecutive beads share; a bead refers to its run by index.
struct Run {
    float height = 0;          ///< mm, of the layer: the bead's center is at z - height / 2
    float speed = 0;           ///< mm/s, the feed rate in force
    std::uint32_t layer = 0;   ///< 1, 2, ... as slicers count; 0 is what comes before the first layer (prime lines)
    std::uint16_t object = 0;  ///< index into Toolpath::objects; 0 is "no object"
    std::uint8_t tool = 0;     ///< T number
    Feature feature = Feature::unknown;
    bool operator==(const Run&) const = default;
};

/// A warning about the input. Equal texts are counted, not repeated.
struct Warning {
    std::string text;
    std::uint32_t first_line = 0;
    std::uint32_t count = 0;
};

/// The filament of a tool has another color from a bead on (a manual change of filament).
struct ColorChange {
    std::uint32_t first_bead = 0;  ///< index into Toolpath::beads; may be one past the last
    std::uint8_t tool = 0;
    Rgb color{};
    bool stated = true;  ///< by the file; else the color is one of kCategoryColors
};

/// A value that holds from a line of the program on, of a tool or of all of them.
struct SetValue {
    std::uint32_t line = 0;  ///< 1-based
    std::uint8_t tool = 0;
    float value = 0;
};

/// Time and speeds of a bead, as the motion planner computes them (src/motion).
struct BeadTiming {
    double start = 0;   ///< s since the program's begin
    float seconds = 0;  ///< that it takes
    float entry = 0;    ///< mm/s along the path, at its start
    float peak = 0;     ///< mm/s, the highest on it
    float exit = 0;     ///< mm/s, at its end
};

/// What flows out along a bead, where the flow was simulated (src/deposit).
struct BeadFlow {
    float volume = 0;  ///< mm^3, laid
    float rate = 0;    ///< mm^3/s, mean
    float widening =
        0;  ///< mm, width at the end less width at the start; Bead::width is the mean. Less than the length
};

/// Everything that one G-code file deposits, in print order.
struct Toolpath {
    std::vector<Bead> beads;
    std::vector<Arc> arcs;
    std::vector<Run> runs;
    std::vector<std::string> objects{""};  ///< names of labelled objects; [0] is unlabelled
    std::vector<Warning> warnings;

    std::string slicer;               ///< e.g. "PrusaSlicer 2.5.0"; empty if the file doesn't say
    std::string firmware;             ///< the rule set used, e.g. "marlin"
    std::string format = "ascii";     ///< the container
    double filament_diameter = 1.75;  ///< mm, of tool 0
    double layer_height = 0;          ///< mm, nominal, from the file's settings; 0 if unknown
    DepositModel deposit;             ///< as asked for: ReadOptions::deposit
    std::uint32_t layer_count = 0;
    double belt_angle = 0;  ///< degrees: turned by it about x the print lies as in the world; 0 but on a belt (belt.h)
    /// By tool, from the file's settings; empty for a tool without one; may be short. Use bead_colors.h.
    std::vector<std::optional<Rgb>> tool_colors;
    std::vector<std::uint8_t> palette_tools;  ///< those of kCategoryColors, for want of a statement: colorUnstated()
    std::vector<ColorChange> color_changes;   ///< in print order
    std::vector<SetValue> temperatures;       ///< degrees Celsius of the nozzles, as the program asks for them
    std::vector<SetValue> fans;               ///< per cent, of the fan that cools the part
    std::vector<SetValue> accelerations;      ///< mm/s^2, of moves that print, as the program asks for them
    std::vector<SetValue> pressure_advances;  ///< s, of the extruders, as the program asks for them
    std::vector<BeadTiming> timing;           ///< by bead; empty unless its motion was planned
    std::vector<BeadFlow> flow;               ///< by bead; empty unless it was simulated
    std::vector<double> filament_by_tool;     ///< mm as the file counts it, by T number; may be short
    std::vector<double> footer_by_tool;       ///< mm of each tool as the file states it; empty if it doesn't
    double footer_mm = 0;                     ///< mm of all tools as the file states it; 0 if it doesn't
    StatedFacts stated;           ///< the file's statements of time, weight, material, nozzle, printer, layers
    std::string extrusion_rule;   ///< unit of E and its source: "mm of filament of 1.75 mm (assumed)"
    std::string firmware_reason;  ///< why that rule set was chosen
    std::string cut_short;        ///< why the program seems truncated; empty if it doesn't
    double filament_mm = 0;       ///< positive E of the beads as the file counts it, in mm of filament
    double prime_mm = 0;          ///< the part of it that is laid before the first layer: prime lines (layer 0)
    double flushed_mm = 0;  ///< pushed out in place while filaments change, in no bead; BambuStudio's sums have it
    /// Pushed out in place between lines beyond what was drawn back ("extra length on restart"), in no bead.
    double primed_mm = 0;
    double extruded_mm3 = 0;  ///< the same as volume, times the flow factor (M221): the expected sum of all beads

    const Run& runOf(const Bead& bead) const { return runs[bead.run]; }
    /// 1-based line in the source; saturates at 2147483647.
    std::uint32_t lineOf(const Bead& bead) const {
        return bead.arc < 0 ? static_cast<std::uint32_t>(-bead.arc) : arcs[static_cast<std::size_t>(bead.arc)].line;
    }
    bool empty() const { return beads.empty(); }
};

/// Length of the path of a bead in mm, its climb included.
double beadLength(const Toolpath& toolpath, const Bead& bead);

/// The direction in which a bead was laid at its place that is nearest to (x, y), mm: its vector in print space, of any
/// length; zero for a bead without length. Arcs turn.
struct PathDirection {
    double x = 0, y = 0, z = 0;
};
PathDirection pathDirection(const Toolpath& toolpath, const Bead& bead, double x, double y);

/// Seconds to lay a bead at the programmed speed, without accelerations; 0 if the file has no speed.
double beadSeconds(const Toolpath& toolpath, const Bead& bead);

/// Mean width of the beads of a selection by their length, mm; 0 of none.
double meanWidth(const Toolpath& toolpath, std::span<const std::uint32_t> selection);

/// Area of a bead's cross-section in mm^2: a stadium of `width` x `height`, or a disc of diameter `width` if narrower.
double sectionArea(double width, double height);

/// Inverse of sectionArea: the width in mm that gives `area` (mm^2) at `height` (mm).
double sectionWidth(double area, double height);

/// Section area times length of a bead, in mm^3.
double beadVolume(const Toolpath& toolpath, const Bead& bead);

/// What bead `index` lays, in mm^3: of the simulated flow if there is one, else its beadVolume().
double laidVolume(const Toolpath& toolpath, std::uint32_t index);

/// The sum of laidVolume() over all beads, in mm^3.
double beadVolume(const Toolpath& toolpath);

/// Width at the end of a bead less width at its start, mm. `bead` is an element of Toolpath::beads.
inline double widening(const Toolpath& toolpath, const Bead& bead) {
    return toolpath.flow.empty()
               ? 0.0
               : static_cast<double>(toolpath.flow[static_cast<std::size_t>(&bead - toolpath.beads.data())].widening);
}

}  // namespace stratum::gcode
