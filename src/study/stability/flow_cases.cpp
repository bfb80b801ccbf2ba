// Flow that lags, advances, stops and starts: what was fed must be somewhere, and every bead have a width.
#include "deposit/read_print.h"
#include "gcode/toolpath/toolpath.h"
#include "study/deposit/made_programs.h"
#include "study/geometry/field_error.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <string>

namespace stratum::study {
namespace {

deposit::PrintRead lagging(const std::string& program, double lag, double advance) {
    gcode::ReadOptions read;
    read.deposit.flow_lag = lag;
    read.deposit.pressure_advance = advance;
    return deposit::readPrint(program, "case", read, false);
}

// Of what has flowed out, the share that is neither in a bead nor purged; infinite if a bead has no width.
double lost(const std::string& program, double lag, double advance) {
    const deposit::PrintRead print = lagging(program, lag, advance);
    double in_beads = 0;
    for (std::size_t n = 0; n < print.toolpath.beads.size(); ++n) {
        const auto width = static_cast<double>(print.toolpath.beads[n].width);
        if (!std::isfinite(width) || !(width > 0)) return std::numeric_limits<double>::infinity();
        in_beads += static_cast<double>(print.toolpath.flow[n].volume);
    }
    const deposit::FlowReport& flow = *print.flow;
    return std::abs(flow.laid - in_beads - flow.purged) / flow.fed;
}

constexpr const char* kNowhere = "share of the plastic that no bead has";
constexpr double kFloatSums = 0x1p-24;

// Retracts and primes after every millimetre.
std::string stringing() {
    std::string text = "M83\nG1 Z0.2 F600\n";
    for (int n = 0; n < 1000; ++n)
        text += fmt::format("G1 X{} E0.03 F1800\nG1 E-0.8 F2400\nG1 X{} F9000\nG1 E0.8 F2400\n", 2 * n + 1, 2 * n + 2);
    return text;
}

std::string micrometres() {
    std::string text = "M83\nG1 Z0.2 F600\nG1 X10 E0.3 F1800\n";
    for (int n = 1; n <= 2000; ++n) text += fmt::format("G1 X{:.3f} E0.00003\n", 10 + 1e-3 * n);
    return text + "G1 X30 E0.6\n";
}

// Out of nothing: primes what was never retracted, and rests.
std::string priming() {
    return "M83\nG1 Z0.2 F600\nG1 X10 E0.3 F1800\nG1 E5 F300\nG4 S2\nG1 X20 E0.3\nG1 E-20 F2400\nG1 X30 E0.3\n";
}

}  // namespace

std::vector<StabilityCase> flowCases() {
    std::vector<StabilityCase> cases;
    struct Program {
        const char* name;
        std::string text;
    };
    const std::vector<Program> programs{{"corner", cornerProgram(8)},
                                        {"1000 retractions", stringing()},
                                        {"2000 moves of a micrometre", micrometres()},
                                        {"primes of nothing", priming()}};
    for (const Program& program : programs)
        for (const double lag : {0.0, 1e-6, 0.04, 10.0})
            cases.push_back({"flow", fmt::format("{}, lag {:g} s", program.name, lag), kNowhere, kFloatSums,
                             "volumes of beads are floats: half a rounding of each",
                             [text = program.text, lag] { return lost(text, lag, 0); }});
    cases.push_back({"flow", "an advance 100 times the lag", kNowhere, kFloatSums,
                     "volumes of beads are floats: half a rounding of each",
                     [] { return lost(cornerProgram(8), 0.02, 2); }});
    for (const double lag : {0.01, 0.1, 1.0})
        cases.push_back(
            {"flow", fmt::format("advance = lag = {:g} s", lag), "largest change of a width, relative", 1e-3,
             "the advance undoes the lag; widths are floats, and fitted within 2 % of what changes", [lag] {
                 double largest = 0;
                 const deposit::PrintRead print = lagging(cornerProgram(8), lag, lag);
                 for (const gcode::Bead& bead : print.toolpath.beads)
                     if (gcode::beadLength(print.toolpath, bead) > 1)
                         largest = std::max(largest, std::abs(static_cast<double>(bead.width) / kCornerWidth - 1));
                 return largest;
             }});
    for (const double lag : {0.01, 0.1})
        cases.push_back({"flow", fmt::format("the grid of a corner that lags by {:g} s", lag),
                         "largest error of the distance, mm",
                         fieldTolerance(lagging(cornerProgram(8), lag, 0).toolpath, plainLattice(0.05, kCornerHeight)),
                         kRoundings, [lag] {
                             return largestFieldError(lagging(cornerProgram(8), lag, 0).toolpath,
                                                      plainLattice(0.05, kCornerHeight));
                         }});
    return cases;
}

}  // namespace stratum::study
