#include "deposit/read_print.h"

#include "base/error.h"
#include "deposit/flow_recorder.h"
#include "motion/clock_fit.h"
#include "motion/planner.h"

#include <fmt/format.h>

namespace stratum::deposit {

PrintRead readPrint(std::string_view bytes, std::string_view name, const gcode::ReadOptions& options, bool timed,
                    std::vector<motion::Travel>* travels) {
    PrintRead print;
    std::optional<FlowRecorder> flow;
    const gcode::DepositModel& deposit = options.deposit;
    if (travels != nullptr && (options.belt_angle || deposit.flow_lag || deposit.sag > 0))
        throw UsageError(
            fmt::format("{}: travels are not told of printers with a belt, and not beside beads that lag "
                        "or sag: leave out either",
                        name));
    if (deposit.flow_lag) flow.emplace(*deposit.flow_lag, deposit.pressure_advance, deposit.nozzle_diameter);
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
    if (!flow) {
        if (deposit.sag > 0) print.sag = sagBeads(print.toolpath, deposit.sag);
        return print;
    }
    const FlowRecord record = flow->finish();
    std::optional<Sag> sag;
    if (deposit.sag > 0) {
        sag.emplace(print.toolpath, deposit.sag);
        print.sag = sag->report();
    }
    BeadCutter cutter(print.toolpath, true, record.parts.size() + record.spots.size());
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
