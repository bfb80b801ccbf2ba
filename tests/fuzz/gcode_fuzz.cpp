// libFuzzer: any text as a program, as commanded and with flow and sag. Only InputError and UsageError may come out of
// reading it, and a toolpath that is read must be one that can be drawn: finite places, positive sections, no index out
// of bounds.
//
// FOLDER collects the inputs that reach new code; tests/fuzz/gcode holds the smallest set of them so far. The first
// byte chooses the options, so that one folder serves all firmwares.
//
// How to build and run it stands in scripts/fuzz.sh.
#include "base/error.h"
#include "deposit/read_print.h"
#include "fuzz/require.h"
#include "gcode/reader.h"
#include "gcode/summary.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace {

void check(const stratum::gcode::Toolpath& toolpath) {
    require(!toolpath.empty());
    for (const stratum::gcode::Bead& bead : toolpath.beads) {
        require(bead.run < toolpath.runs.size());
        require(bead.arc < static_cast<std::int32_t>(toolpath.arcs.size()));
        require(toolpath.lineOf(bead) > 0);
        require(std::isfinite(bead.width) && bead.width > 0);
        for (const double place : {bead.x0, bead.y0, bead.z0, bead.x1, bead.y1, bead.z1}) require(std::isfinite(place));
        const stratum::gcode::Run& run = toolpath.runOf(bead);
        require(std::isfinite(run.height) && run.height > 0);
        require(run.object < toolpath.objects.size());
        require(std::isfinite(stratum::gcode::beadLength(toolpath, bead)));
    }
    for (std::size_t n = 0; n < toolpath.flow.size(); ++n) {
        const stratum::gcode::BeadFlow& flow = toolpath.flow[n];
        require(std::isfinite(flow.volume) && flow.volume >= 0 && std::isfinite(flow.rate));
        const double length = stratum::gcode::beadLength(toolpath, toolpath.beads[n]);
        require(std::abs(static_cast<double>(flow.widening)) <= length * (1 + 1e-6));
    }
    require(std::isfinite(toolpath.extruded_mm3));
    require(!stratum::gcode::summarize(toolpath).empty());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    stratum::gcode::ReadOptions options;
    options.firmware = static_cast<stratum::gcode::Firmware>(data[0] & 3U);
    options.extruder_mode = static_cast<stratum::gcode::ExtruderMode>((data[0] >> 2U & 3U) % 3);
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    try {
        check(stratum::gcode::readToolpath(text, "fuzz", options));
        options.deposit.flow_lag = (data[0] & 16U) != 0 ? 1.0 : 0.02;
        options.deposit.sag = 0.1;
        options.deposit.strings = (data[0] & 32U) != 0;
        check(stratum::deposit::readPrint(text, "fuzz", options, true).toolpath);
    } catch (const stratum::InputError&) {
    } catch (const stratum::UsageError&) {
    }
    return 0;
}
