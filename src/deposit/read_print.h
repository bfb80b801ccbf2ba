// Bytes -> Toolpath of what the plastic does: the reader, and the effects that DepositModel asks for.
#pragma once

#include "deposit/lay_flow.h"
#include "deposit/sag.h"
#include "gcode/reader.h"
#include "motion/print_times.h"

#include <optional>
#include <string_view>

namespace stratum::deposit {

struct PrintRead {
    gcode::Toolpath toolpath;
    std::optional<motion::PrintTimes> times;  ///< if asked for; Toolpath::timing is then filled
    std::optional<FlowReport> flow;           ///< if ReadOptions::deposit has a lag
    std::optional<SagReport> sag;             ///< if it has a sag
};

/// Reads a program; plans its motion only if `timed` or if the flow is simulated. Throws what readToolpath() throws.
/// The search for what sags runs on all threads, the rest on one. Re-entrant.
PrintRead readPrint(std::string_view bytes, std::string_view name, const gcode::ReadOptions& options, bool timed);

}  // namespace stratum::deposit
