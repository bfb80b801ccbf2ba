#include "assemble/print/read_print_options.h"

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

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

namespace stratum::assemble {

void readReading(OptionSource& options, voxelize::PrintOptions& print) {
    gcode::ReadOptions& read = print.read;
    // First: the options after it override what the preset says.
    if (const auto printer = options.text("printer")) {
        deposit::usePrinter(*printer, read);
        print.printer = *printer;
    }
    assign(read.plate, options.integer("plate", 1, std::numeric_limits<int>::max()));
    if (std::vector<double> diameters = options.list("filament_diameter"); !diameters.empty()) {
        for (const double diameter : diameters)
            if (!(diameter >= 0.1 && diameter <= 20)) options.refuse("filament_diameter", "0.1 to 20 mm");
        read.filament_diameters = std::move(diameters);
    }
    if (const std::vector<std::string> colors = options.texts("filament_colors"); !colors.empty())
        read.filament_colors =
            toolColorsOf(fmt::format("{}", fmt::join(colors, ",")), options.called("filament_colors")).colors;
    if (const auto text = options.text("tool_offsets"))
        read.tool_offsets = gcode::toolOffsetsOf(*text, options.called("tool_offsets"));
    assign(read.layer_height, options.numberIn("layer_height", 0.001, 50));
    assign(read.belt_angle, options.numberIn("belt", gcode::kFlattestBelt, gcode::kSteepestBelt));
    assign(read.planar, options.flag("planar"));
    assign(read.extruder_mode, options.choice("e_mode", gcode::kExtruderModes));
    assign(read.firmware, options.choice("firmware", gcode::kFirmwares));
    assign(read.corner_rule, options.choice("planner", gcode::kCornerRules));
    assign(read.deposit.beads, options.choice("beads", gcode::kBeadModels));
    if (const auto section = options.text("section")) deposit::parseSection(*section, read.deposit);
    assign(read.flow_percent, options.numberIn("flow", 1, gcode::kMostFlow));
    assign(read.deposit.flow_lag, options.numberIn("flow_lag", 0, deposit::kLongestLag));
    assign(read.deposit.pressure_advance, options.numberIn("pressure_advance", 0, gcode::kLongestAdvance));
    assign(read.deposit.sag, options.numberIn("sag", 0, deposit::kMostSag));
    assign(read.deposit.crown, options.numberIn("crown", 0, gcode::kMostCrown));
    assign(read.deposit.strings, options.flag("strings"));
    for (const std::string_view option : {"pressure_advance", "strings"})
        if (!read.deposit.flow_lag && options.given(option))
            options.refuse(option, "a printer whose flow lags: printer typical, or a flow_lag");
}

void readSelection(OptionSource& options, voxelize::PrintOptions& print) {
    assign(print.layers, options.text("layers"));
    print.features = fmt::format("{}", fmt::join(options.texts("features"), ","));
    print.objects = options.texts("objects");
    for (const double tool : options.list("tools")) {
        if (!(tool >= 0 && tool <= 255) || tool != static_cast<int>(tool))
            options.refuse("tools", "T numbers, 0 to 255");
        print.tools.push_back(static_cast<std::uint8_t>(tool));
    }
}

void readLattice(OptionSource& options, voxelize::PrintOptions& print, bool pictures) {
    if (pictures && options.says("voxel_size", "auto"))
        print.voxel_auto = true;
    else
        assign(print.lattice.voxel_size, options.number("voxel_size"));
    assign(print.lattice.voxels_per_layer, options.integer("voxels_per_layer", 1, 64));
    assign(print.tolerance, options.number("tolerance"));
    assign(print.memory_budget, options.text("memory_budget"));
    constexpr std::array<std::string_view, 4> kWays{"voxel_size", "voxels_per_layer", "tolerance", "memory_budget"};
    if (std::ranges::count_if(kWays, [&options](std::string_view way) { return options.given(way); }) > 1)
        throw UsageError(fmt::format("{}, {}, {} and {} all choose the voxel; give one of them",
                                     options.called("voxel_size"), options.called("voxels_per_layer"),
                                     options.called("tolerance"), options.called("memory_budget")));
    assign(print.lattice.half_width, options.number("half_width"));
}

void readConversion(OptionSource& options, voxelize::PrintOptions& print, bool pictures) {
    readLattice(options, print, pictures);
    readSelection(options, print);
}

}  // namespace stratum::assemble
