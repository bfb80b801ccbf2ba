#include "deposit/read_print.h"

#include "base/error.h"
#include "deposit/flow_recorder.h"
#include "motion/clock_fit.h"
#include "motion/planner.h"

#include <fmt/format.h>

#include <vector>

namespace stratum::deposit {
namespace {

// What is without effect, because another part of the model is missing.
void warnOfUnused(const gcode::DepositModel& deposit, std::vector<gcode::Warning>& warnings) {
    if (deposit.crown > 0 && !deposit.swells())
        warnings.push_back({fmt::format("crowns ({:g} % of the height) are left out: only settled beads have them",
                                        100 * deposit.crown),
                            1, 1});
    if (deposit.pressure_advance.value_or(0) > 0 && !deposit.flow_lag)
        warnings.push_back({fmt::format("pressure advance ({:g} s) is left out: it makes up for a lag of the flow, and "
                                        "none is given",
                                        *deposit.pressure_advance),
                            1, 1});
}

// Strings of what cannot ooze, or of which the places are not known.
void refuseStrings(std::string_view name, const gcode::ReadOptions& options) {
    if (!(options.deposit.flow_lag.value_or(0) > 0))
        throw UsageError(
            fmt::format("{}: strings are of what oozes, and without a lag of the flow nothing does; give "
                        "a lag above 0 s (--flow-lag 0.05), too",
                        name));
}

// What is told of level layers on a bed alone.
void refuseOnBelt(std::string_view name, const gcode::DepositModel& deposit, bool travels) {
    const char* what = travels ? "travels are" : deposit.strings ? "strings are" : nullptr;
    if (what != nullptr)
        throw UsageError(fmt::format("{}: {} not told of prints on a belt; leave that out", name, what));
}

// The same of sag, which is part of presets of printers.
void leaveOutSag(gcode::Toolpath& toolpath) {
    if (!(toolpath.deposit.sag > 0)) return;
    toolpath.deposit.sag = 0;
    toolpath.warnings.push_back(
        {"sag is left out: it is told of level layers, and those of a print on a belt lean", 1, 1});
}

}  // namespace

PrintRead readPrint(std::string_view bytes, std::string_view name, const gcode::ReadOptions& options, bool timed,
                    std::vector<motion::Travel>* travels) {
    PrintRead print;
    std::optional<FlowRecorder> flow;
    const gcode::DepositModel& deposit = options.deposit;
    if (travels != nullptr && (deposit.flow_lag || deposit.sag > 0))
        throw UsageError(fmt::format("{}: travels are not told beside beads that lag or sag: leave out either", name));
    if (deposit.strings) refuseStrings(name, options);
    if (deposit.flow_lag)
        flow.emplace(*deposit.flow_lag, deposit.pressure_advance, deposit.nozzle_diameter, deposit.strings);
    if (timed) {
        print.toolpath =
            motion::readTimedToolpath(bytes, name, options, print.times.emplace(), flow ? &*flow : nullptr, travels);
    } else if (flow) {
        motion::Planner planner(*flow);
        motion::ClockFit fit(planner);
        gcode::ReadOptions read = options;
        read.motion = &fit;
        print.toolpath = gcode::readToolpath(bytes, name, read);
        fit.finish();
        planner.finish();
    } else if (travels != nullptr) {
        motion::TravelRecorder moves(*travels, nullptr);
        gcode::ReadOptions read = options;
        read.motion = &moves;
        print.toolpath = gcode::readToolpath(bytes, name, read);
    } else {
        print.toolpath = gcode::readToolpath(bytes, name, options);
    }
    if (print.toolpath.belt_angle != 0) {
        refuseOnBelt(name, deposit, travels != nullptr);
        leaveOutSag(print.toolpath);
    }
    const double sag_fraction = print.toolpath.deposit.sag;
    warnOfUnused(deposit, print.toolpath.warnings);
    if (!flow) {
        if (sag_fraction > 0) print.sag = sagBeads(print.toolpath, sag_fraction);
        return print;
    }
    const FlowRecord record = flow->finish();
    std::optional<Sag> sag;
    if (sag_fraction > 0) {
        sag.emplace(print.toolpath, sag_fraction);
        print.sag = sag->report();
    }
    BeadCutter cutter(print.toolpath, true, record.parts.size() + record.spots.size() + record.strings.size());
    print.flow = layFlow(record, print.toolpath, [&](const BeadPiece& piece) {
        if (sag)
            sag->lay(piece, cutter);
        else
            cutter.add(piece);
    });
    print.flow->lag = *deposit.flow_lag;
    cutter.finish();
    if (print.toolpath.empty())
        throw InputError(fmt::format("{}: nothing flows out with a lag of {:g} s; is the lag longer than the print?",
                                     name, *deposit.flow_lag));
    return print;
}

}  // namespace stratum::deposit
