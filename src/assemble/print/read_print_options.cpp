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
    if (const auto plate = options.integer("plate", 1, std::numeric_limits<int>::max()))
        read.plate = static_cast<int>(*plate);
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
    if (const auto height = options.numberIn("layer_height", 0.001, 50)) read.layer_height = *height;
    if (const auto angle = options.numberIn("belt", gcode::kFlattestBelt, gcode::kSteepestBelt))
        read.belt_angle = *angle;
    assign(read.planar, options.flag("planar"));
    assign(read.extruder_mode, options.choice("e_mode", gcode::kExtruderModes));
    assign(read.firmware, options.choice("firmware", gcode::kFirmwares));
    assign(read.corner_rule, options.choice("planner", gcode::kCornerRules));
    assign(read.deposit.beads, options.choice("beads", gcode::kBeadModels));
    if (const auto section = options.text("section")) deposit::parseSection(*section, read.deposit);
    assign(read.flow_percent, options.numberIn("flow", 1, gcode::kMostFlow));
    if (const auto lag = options.numberIn("flow_lag", 0, deposit::kLongestLag)) read.deposit.flow_lag = *lag;
    if (const auto advance = options.numberIn("pressure_advance", 0, gcode::kLongestAdvance))
        read.deposit.pressure_advance = *advance;
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
    int ways = 0;
    if (pictures && options.says("voxel_size", "auto"))
        print.voxel_auto = true;
    else if (const auto size = options.number("voxel_size"))
        print.lattice.voxel_size = *size;
    ways += print.voxel_auto || print.lattice.voxel_size ? 1 : 0;
    if (const auto count = options.integer("voxels_per_layer", 1, 64)) {
        print.lattice.voxels_per_layer = static_cast<int>(*count);
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
