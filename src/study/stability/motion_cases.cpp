// Moves that a planner of motion must come through: none, thousands of a micrometre, and accelerations of all sizes.
#include "deposit/read_print.h"
#include "motion/planner.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace stratum::study {
namespace {

using gcode::CornerRule;

// Nobody wants the pieces.
class Unheard : public motion::PlanSink {
public:
    void piece(const motion::PlannedPiece&) override {}
    void wait(double, double) override {}
};

struct Limits {
    double acceleration = 1000;  // mm/s^2
    CornerRule rule = CornerRule::corner_velocity;
};

gcode::MachineLimits machineOf(const Limits& limits) {
    gcode::MachineLimits machine;
    machine.speed.fill(1e9);
    machine.acceleration.fill(1e9);
    machine.printing = machine.travel = machine.retracting = limits.acceleration;
    machine.rule = limits.rule;
    machine.cruise_ratio = 0;
    return machine;
}

// Seconds of `count` moves along x, each of `length` mm at `speed` mm/s; every other one back if `turns`.
double secondsOf(const Limits& limits, int count, double length, double speed, bool turns = false) {
    Unheard sink;
    motion::Planner planner(sink);
    planner.limits(machineOf(limits));
    gcode::Move move;
    move.speed = speed;
    for (int n = 0; n < count; ++n) {
        move.delta[0] = turns && n % 2 == 1 ? -length : length;
        planner.move(move);
    }
    planner.finish();
    return planner.seconds();
}

// From rest to rest.
double closedForm(double length, double speed, double acceleration) {
    const double ramp = speed * speed / acceleration;
    return length >= ramp ? length / speed + speed / acceleration : 2 * std::sqrt(length / acceleration);
}

StabilityCase motionCase(std::string name, std::string quantity, double tolerance, std::string why,
                         std::function<double()> measure) {
    return {"motion", std::move(name), std::move(quantity), tolerance, std::move(why), std::move(measure)};
}

constexpr const char* kOff = "relative error of the time";

void addAccelerations(std::vector<StabilityCase>& cases) {
    for (const double acceleration : {1e-3, 1.0, 1e3, 1e7})
        for (const double length : {1e-4, 1.0, 1e4})
            cases.push_back(motionCase(fmt::format("{:g} mm at {:g} mm/s\u00b2", length, acceleration), kOff,
                                       64 * 0x1p-53, "from rest to rest in closed form: some 64 roundings of doubles",
                                       [=] {
                                           const double exact = closedForm(length, 100, acceleration);
                                           return std::abs(secondsOf({acceleration}, 1, length, 100) / exact - 1);
                                       }));
    cases.push_back(motionCase("10000 reversals on the spot", kOff, 1e4 * 0x1p-53,
                               "each is from rest to rest: a rounding of their sum each", [] {
                                   const double exact = 1e4 * closedForm(0.5, 100, 1000);
                                   return std::abs(secondsOf({}, 10000, 0.5, 100, true) / exact - 1);
                               }));
}

void addPieces(std::vector<StabilityCase>& cases) {
    // A line in pieces has no corners: the rules must not find some.
    struct Rule {
        CornerRule rule;
        const char* words;
        int most_pieces;
    };
    // Marlin 2 knows 14 pieces: they must be long enough to brake in.
    constexpr std::array<Rule, 7> kRules{{{CornerRule::jerk, "classic jerk", 40000},
                                          {CornerRule::slicer_jerk, "the slicers' jerk", 40000},
                                          {CornerRule::plan_jerk, "jerk in the plan", 40000},
                                          {CornerRule::junction_deviation, "junction deviation", 1000},
                                          {CornerRule::corner_velocity, "corner velocity", 40000},
                                          {CornerRule::marlin_jerk, "Marlin 2's jerk", 1000},
                                          {CornerRule::reprap_jerk, "RepRapFirmware's jerk", 40000}}};
    for (const auto& [rule, words, most_pieces] : kRules)
        for (const int pieces : {most_pieces / 40, most_pieces})
            cases.push_back(
                motionCase(fmt::format("a line in {} pieces, {}", pieces, words), kOff, pieces * 0x1p-50,
                           "the time of the whole line: eight roundings a piece", [rule = rule, pieces] {
                               const double whole = secondsOf({1000, rule}, 1, 400, 100);
                               return std::abs(secondsOf({1000, rule}, pieces, 400.0 / pieces, 100) / whole - 1);
                           }));
}

// 0 if a program is planned to a finite time that is not negative, else 1.
double noTime(const std::string& program) {
    const deposit::PrintRead print = deposit::readPrint(program, "case", {}, true);
    return std::isfinite(print.times->total) && print.times->total >= 0 ? 0 : 1;
}

void addPrograms(std::vector<StabilityCase>& cases) {
    const std::string head = "M83\nG1 Z0.2 F600\nG1 X10 E1 F1200\n";
    const std::array<std::pair<const char*, std::string>, 6> programs{
        {{"speed 0", head + "G1 F0\nG1 X20 E1\n"},
         {"speed of a nanometre a minute", head + "G1 F0.000001\nG1 X20 E1\n"},
         {"acceleration 0", head + "M204 P0 T0 R0\nM201 X0 Y0 Z0 E0\nG1 X20 E1 F1200\n"},
         {"jerk 0", head + "M205 X0 Y0 Z0 E0\nG1 X20 E1 F1200\nG1 X10 Y5 E1\n"},
         {"pauses of a year", head + "G4 S31536000\nG1 X20 E1\nG4 P0\n"},
         {"a move of nothing", head + "G1 X10\nG1 E0\nG1\nG1 X20 E1\n"}}};
    for (const auto& [name, program] : programs)
        cases.push_back(motionCase(name, "no finite time (1) or one (0)", 0, "every program takes some time",
                                   [program = program] { return noTime(program); }));
}

}  // namespace

std::vector<StabilityCase> motionCases() {
    std::vector<StabilityCase> cases;
    addAccelerations(cases);
    addPieces(cases);
    addPrograms(cases);
    return cases;
}

}  // namespace stratum::study
