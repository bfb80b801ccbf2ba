// Numbers of a print, each with its definition and unit: the entrance of this room for other programs.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "motion/print_times.h"
#include "report/definitions.h"
#include "voxelize/beads/lattice.h"

#include <openvdb/openvdb.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stratum::report {

struct ReportOptions {
    std::string source;             ///< name of the file, to be shown; may be empty
    std::string selection;          ///< what of it, in words; empty: all
    bool culled = false;            ///< the grid was built with Interior::cull, so nothing is known of its inside
    std::optional<double> density;  ///< g/cm^3, of all tools; overrides the file's
    std::optional<double> price;    ///< of a kg, of all tools; overrides the file's
};

using Vector3 = std::array<double, 3>;
using Matrix3 = std::array<Vector3, 3>;

/// One number of the whole print.
struct Number {
    const Definition* definition = nullptr;
    std::variant<double, Vector3, Matrix3> value;
    std::vector<std::pair<std::string, std::variant<double, Vector3>>> details;  ///< by key: where, how many
};

/// A number that can't be told of this print.
struct LeftOut {
    const Definition* definition = nullptr;
    std::string why, remedy;
};

/// One value a layer or slab; NaN where there is none.
struct Column {
    const Definition* definition = nullptr;
    std::vector<double> values;
};

struct ToolUse {
    std::size_t tool = 0;
    std::string material;  ///< as the file names it; may be empty
    double filament_mm = 0, volume_mm3 = 0;
    std::optional<double> density, price;  ///< g/cm^3, a kg
};

struct PrintReport {
    std::string source, selection, slicer, bead_model;
    double voxel_mm = 0, layer_height_mm = 0;
    bool culled = false;
    std::vector<Number> numbers;
    std::vector<LeftOut> left_out;
    std::vector<ToolUse> tools;
    std::vector<std::uint32_t> layers;  ///< numbers
    std::vector<Column> by_layer;
    std::vector<std::pair<double, double>> slabs;  ///< from and to, mm
    bool slabs_are_layers = false;
    std::vector<Column> by_slab;

    /// Null if it was left out.
    const Number* find(std::string_view key) const;
    const Column* findColumn(std::string_view key) const;  ///< by layer or by slab
};

/// Measures a print. `grid` is the level set of the beads of `selection` (ascending, not empty) on `lattice`, kept or
/// culled (ReportOptions::culled), in any placement: the report is in millimetres of the print. `times` are those of
/// the whole program. Reads the grid, which must not change meanwhile. Parallel; the same numbers for any number of
/// threads.
PrintReport makeReport(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                       std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                       const std::optional<motion::PrintTimes>& times, const ReportOptions& options);

/// {"print": {...}, "numbers": {key: {"title", "value", "unit", "definition", ...details}}, "tools": [...],
/// "by_layer": {"layer": [...], "columns": {key: {"title", "unit", "definition", "values"}}},
/// "by_height": {"from_mm", "to_mm", "columns"}, "left_out": [{"number", "title", "why", "remedy"}]}. Values are
/// numbers, lists of three, or three lists of three; null in columns where there is none.
nlohmann::ordered_json toJson(const PrintReport& report);

/// Both at once.
nlohmann::ordered_json reportOf(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                                std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                                const std::optional<motion::PrintTimes>& times, const ReportOptions& options);

}  // namespace stratum::report
