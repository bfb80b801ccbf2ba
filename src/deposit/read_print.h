// Bytes -> Toolpath of what the plastic does: the reader, and the effects that DepositModel asks for.
#pragma once

#include "deposit/lay_flow.h"
#include "deposit/sag.h"
#include "gcode/reader.h"
#include "motion/print_times.h"

#include <optional>
#include <string_view>
#include <vector>

namespace stratum::deposit {

struct PrintRead {
    gcode::Toolpath toolpath;
    std::optional<motion::PrintTimes> times;  ///< if asked for; Toolpath::timing is then filled
    std::optional<FlowReport> flow;           ///< if ReadOptions::deposit has a lag
    std::optional<SagReport> sag;             ///< if it has a sag
};

/// Reads a program; plans its motion only if `timed` or if the flow is simulated. Throws what readToolpath() throws.
/// The search for what sags runs on all threads, the rest on one. Re-entrant.
/// @param travels  gets the moves that lay nothing, if not null. Throws UsageError where their places or beads would
/// not be those of the toolpath: of a belt, and where beads lag or sag.
PrintRead readPrint(std::string_view bytes, std::string_view name, const gcode::ReadOptions& options, bool timed,
                    std::vector<motion::Travel>* travels = nullptr);

}  // namespace stratum::deposit
