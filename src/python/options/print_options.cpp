#include "python/options/print_options.h"

#include "assemble/print/print_colors.h"
#include "base/error.h"
#include "deposit/printer.h"
#include "deposit/sag.h"
#include "gcode/machine/belt.h"
#include "gcode/option_names.h"
#include "gcode/printer/machine_limits.h"
#include "gcode/slicer/settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>

namespace stratum::python {

namespace py = pybind11;

gcode::ReadOptions readOptionsOf(Keywords& options) {
    gcode::ReadOptions read;
    // First: the options after it override what the preset says.
    if (const auto printer = options.text("printer")) deposit::usePrinter(*printer, read);
    if (const auto plate = options.integer("plate", 1, std::numeric_limits<int>::max())) read.plate = *plate;
    read.filament_diameters = options.numbers("filament_diameter");
    for (const double diameter : read.filament_diameters)
        if (!(diameter >= 0.1 && diameter <= 20))
            throw UsageError(
                fmt::format("{}(): filament_diameter={:g}: expected 0.1 to 20 mm", options.function(), diameter));
    if (const std::vector<std::string> colors = options.texts("filament_colors"); !colors.empty())
        read.filament_colors = assemble::toolColorsOf(fmt::format("{}", fmt::join(colors, ",")),
                                                      options.function() + "(): filament_colors")
                                   .colors;
    if (const auto text = options.text("tool_offsets"))
        read.tool_offsets = gcode::toolOffsetsOf(*text, options.function() + "(): tool_offsets");
    if (const auto height = options.number("layer_height", 0.001, 50)) read.layer_height = *height;
    if (const auto angle = options.number("belt", gcode::kFlattestBelt, gcode::kSteepestBelt)) read.belt_angle = *angle;
    assign(read.planar, options.flag("planar"));
    assign(read.extruder_mode, options.choice("e_mode", gcode::kExtruderModes));
    assign(read.firmware, options.choice("firmware", gcode::kFirmwares));
    assign(read.corner_rule, options.choice("planner", gcode::kCornerRules));
    assign(read.deposit.beads, options.choice("beads", gcode::kBeadModels));
    if (const auto section = options.text("section")) deposit::parseSection(*section, read.deposit);
    assign(read.flow_percent, options.number("flow", 1, gcode::kMostFlow));
    if (const auto lag = options.number("flow_lag", 0, deposit::kLongestLag)) read.deposit.flow_lag = *lag;
    if (const auto advance = options.number("pressure_advance", 0, gcode::kLongestAdvance))
        read.deposit.pressure_advance = *advance;
    assign(read.deposit.crown, options.number("crown", 0, gcode::kMostCrown));
    assign(read.deposit.sag, options.number("sag", 0, deposit::kMostSag));
    assign(read.deposit.strings, options.flag("strings"));
    return read;
}

void readSelection(Keywords& options, voxelize::PrintOptions& print) {
    assign(print.layers, options.text("layers"));
    for (const std::string& list : options.texts("features"))
        print.features += (print.features.empty() ? "" : ",") + list;
    print.objects = options.texts("objects");
    for (const double tool : options.numbers("tools")) {
        if (!(tool >= 0 && tool <= 255) || tool != static_cast<int>(tool))
            throw UsageError(
                fmt::format("{}(): tools: expected T numbers, 0 to 255, not {:g}", options.function(), tool));
        print.tools.push_back(static_cast<std::uint8_t>(tool));
    }
}

voxelize::PrintOptions printOptionsOf(Keywords& options, bool pictures) {
    voxelize::PrintOptions print;
    int ways = 0;
    const auto given = options.find("voxel_size");
    if (pictures && given && py::isinstance<py::str>(*given) && given->cast<std::string>() == "auto")
        print.voxel_auto = true;
    else if (const auto size = options.number("voxel_size"))
        print.lattice.voxel_size = *size;
    ways += given ? 1 : 0;
    if (const auto count = options.integer("voxels_per_layer", 1, 64)) {
        print.lattice.voxels_per_layer = *count;
        ++ways;
    }
    if (const auto tolerance = options.number("tolerance")) {
        print.tolerance = *tolerance;
        ++ways;
    }
    if (const auto budget = options.text("memory_budget")) {
        print.memory_budget = *budget;
        ++ways;
    }
    if (ways > 1)
        throw UsageError(fmt::format(
            "{}(): voxel_size, voxels_per_layer, tolerance and memory_budget all choose the voxel; give one of them",
            options.function()));
    assign(print.lattice.half_width, options.number("half_width"));
    readSelection(options, print);
    return print;
}

}  // namespace stratum::python
