// Selects the beads to be voxelized: layers, features, objects, tools and partial prints.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::voxelize {

/// A filter over beads; the default keeps all layers of the print, without prime lines.
struct Selection {
    std::uint32_t first_layer = 1;  ///< inclusive; 0 includes what is extruded before the first layer (prime lines)
    std::uint32_t last_layer = 0xffffffff;
    std::array<bool, gcode::kFeatureCount> features;
    std::vector<std::uint16_t> objects;  ///< indices into Toolpath::objects; empty takes all beads, labelled or not
    std::vector<std::uint8_t> tools;     ///< T numbers; empty takes all

    Selection() { features.fill(true); }
};

/// Parses "A:B" (inclusive, either end may be left out: from 1, to the last) or "A" into the layer range. Layer 0 is
/// what is extruded before the first layer. Throws UsageError.
void parseLayers(std::string_view text, Selection& selection);

/// Parses "all", "+perimeter,+infill" (only these) or "-skirt,-brim,-support" (all but these). Throws UsageError with
/// the list of names for an unknown one.
void parseFeatures(std::string_view text, Selection& selection);

/// Adds the object of that name, or else of that number (1, 2, ... in the order in which the file names them; 0 are
/// beads without an object). Throws UsageError with the list of objects if there is none.
void chooseObject(std::string_view name_or_number, const gcode::Toolpath& toolpath, Selection& selection);

/// Adds the tool of that T number. Throws UsageError with the list of the print's tools if it prints nothing.
void chooseTool(std::uint8_t tool, const gcode::Toolpath& toolpath, Selection& selection);

/// Indices of the selected beads, ascending. Throws InputError, with a list of what the print has, if there are none.
std::vector<std::uint32_t> selectBeads(const gcode::Toolpath& toolpath, const Selection& selection);

/// Whether such a list names a time, which needs a planned motion (Toolpath::timing) to be accurate.
bool needsTiming(std::string_view snapshots);

/// A partial print: everything printed before bead number `bead_count`.
struct Snapshot {
    std::string label;  ///< for the file name, e.g. "025pct", "layer0040", "0090min": they sort as they print
    std::size_t bead_count = 0;
};

/// Parses a list of "25%" (of the volume of the layers, without prime lines), "layer:40" (through layer 40), "every:10"
/// (after each 10 layers) and "time:90" (everything printed after 90 minutes; also time:5400s, time:90m, time:1.5h, and
/// time:50%, of the time to the last bead). Times are those of Toolpath::timing; without it, of extruding at the
/// programmed speeds. In print order, without duplicates. Throws UsageError, which names the option of the text.
std::vector<Snapshot> parseSnapshots(std::string_view text, const gcode::Toolpath& toolpath,
                                     std::string_view option = "--snapshots");

}  // namespace stratum::voxelize
