// --compare: how far a print is from its model.
#pragma once

#include "convert/conversion.h"

#include "compare/closed_model.h"
#include "compare/comparison.h"
#include "gcode/toolpath/toolpath.h"
#include "voxelize/beads/lattice.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <span>

namespace stratum::tools {

/// The model, and what was found.
struct ModelComparison {
    std::unique_ptr<const compare::ClosedModel> model;
    compare::Comparison found;
};

void addCompareOptions(CLI::App& app, CompareCommand& options);

/// Reads the model and compares the outside of the selected beads with it, without those that slicers add to a model:
/// skirts, brims, supports, wipe towers. Prints what it finds. Throws InputError, UsageError.
ModelComparison compareWithModel(const ConvertCommand& command, const gcode::Toolpath& toolpath,
                                 std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice);

/// Takes "deviation" out of the list of --grids; whether it was there. Throws UsageError without --compare.
bool takeDeviation(ConvertCommand& command);

}  // namespace stratum::tools
