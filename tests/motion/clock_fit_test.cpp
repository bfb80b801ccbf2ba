#include "motion/clock_fit.h"

#include "gcode/slicer/cura.h"
#include "motion/print_times.h"
#include "motions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::Limit;
using gcode::LimitOrigin;

constexpr std::string_view kHead = ";FLAVOR:Marlin\n;Generated with Cura_SteamEngine 5.0.0\nM83\nG1 X50 Z5 F600\n";

// Strokes forth and back, which are longer from layer to layer.
std::string layer(int number) {
    const double length = 1 + 1.7 * (number % 9);
    std::string text = fmt::format("G0 F9000 X0 Y0 Z{:.1f}\nG1 F3600\n", 0.2 * (number + 1));
    const int strokes = static_cast<int>(800 / length);
    for (int n = 1; n <= strokes; ++n)
        text += fmt::format("G1 X{:.2f} Y{:.2f} E{:.3f}\n", n % 2 == 1 ? length : 0.0, 0.2 * n, 0.04 * length);
    return text;
}

// Plans by limits of its own, whatever the program's are.
class FixedLimits : public gcode::MotionSink {
public:
    FixedLimits(Planner& planner, const gcode::MachineLimits& limits) : planner_(planner) { planner_.limits(limits); }
    void limits(const gcode::MachineLimits&) override {}
    void move(const gcode::Move& move) override { planner_.move(move); }
    void wait(double seconds) override { planner_.wait(seconds); }

private:
    Planner& planner_;
};

double secondsOf(const std::string& program, double acceleration, double jerk) {
    gcode::MachineLimits limits = gcode::curaLimits("");
    limits.printing = limits.travel = limits.retracting = acceleration;
    limits.jerk[0] = limits.jerk[1] = jerk;
    PlanKeeper keeper;
    Planner planner(keeper);
    FixedLimits fixed(planner, limits);
    gcode::ReadOptions options;
    options.motion = &fixed;
    gcode::readToolpath(program, "test.gcode", options);
    planner.finish();
    return planner.seconds();
}

struct Machine {
    double acceleration = 700;
    double jerk = 8;
    int layers = 12;
    std::vector<double> wrong{1};  // factors of the layers' times, in turn
    std::string head{};            // given, or GCC 14 warns where it is left out
};

// The times behind the layers are those of the machine.
std::string programOf(const Machine& machine) {
    std::string program = machine.head + std::string(kHead);
    double before = secondsOf(program + "G1 X51 E.1\n", machine.acceleration, machine.jerk);
    double clock = 0;
    for (int n = 0; n < machine.layers; ++n) {
        program += fmt::format(";LAYER:{}\n{}", n, layer(n));
        const double now = secondsOf(program, machine.acceleration, machine.jerk);
        clock += (now - before) * machine.wrong[static_cast<std::size_t>(n) % machine.wrong.size()];
        before = now;
        program += fmt::format(";TIME_ELAPSED:{:.6f}\n", clock);
    }
    return program + ";End of Gcode\n";
}

PrintTimes timesOf(const std::string& program) {
    PrintTimes times;
    readTimedToolpath(program, "test.gcode", {}, times);
    return times;
}

TEST(ClockFit, TimesOfLayersTellAccelerationAndJerk) {
    for (const Machine& machine : {Machine{}, Machine{.acceleration = 1500, .jerk = 12}}) {
        const std::string program = programOf(machine);
        const PrintTimes times = timesOf(program);
        EXPECT_EQ(times.limits[Limit::printing].kind, LimitOrigin::Kind::fitted);
        EXPECT_NEAR(times.limits[Limit::printing].value, machine.acceleration, 0.02 * machine.acceleration);
        EXPECT_NEAR(times.limits[Limit::jerk].value, machine.jerk, 0.05 * machine.jerk);
        const double real = secondsOf(program, machine.acceleration, machine.jerk);
        EXPECT_NEAR(times.total, real, 0.002 * real);
        const double guess = secondsOf(program, 4000, 20);
        EXPECT_GT(real, 1.1 * guess);
    }
}

TEST(ClockFit, SomeLayersMayHaveTimesOfOtherCauses) {
    const PrintTimes times = timesOf(programOf({.layers = 20, .wrong = {1, 1, 1, 3}}));
    EXPECT_NEAR(times.limits[Limit::printing].value, 700, 14);
    EXPECT_NEAR(times.limits[Limit::jerk].value, 8, 0.4);
}

TEST(ClockFit, LeavesWhatIsStated) {
    const std::string machine = programOf({.head = ";TARGET_MACHINE.NAME:Creality Ender-3\n"});
    EXPECT_EQ(timesOf(machine).limits[Limit::printing].kind, LimitOrigin::Kind::setting);
    EXPECT_EQ(timesOf(machine).limits[Limit::printing].value, 500);
    for (const char* command : {"M204 S900\n", "M205 X9\n", "M201 X800 Y800\n"}) {
        const std::string program = programOf({.head = command});
        const PrintTimes times = timesOf(program);
        EXPECT_EQ(times.limits[Limit::printing].kind, LimitOrigin::Kind::assumed) << command;
    }
}

// Numbers that were only made to agree would be worse than an assumption that says so.
TEST(ClockFit, LeavesTimesThatNoLimitsExplain) {
    const std::string program = programOf({.wrong = {1.3, 0.8, 1.1}});
    const PrintTimes times = timesOf(program);
    EXPECT_EQ(times.limits[Limit::printing].kind, LimitOrigin::Kind::assumed);
    EXPECT_NEAR(times.total, secondsOf(program, 4000, 20), 1e-6);
    EXPECT_EQ(timesOf(programOf({.layers = 7})).limits[Limit::printing].kind, LimitOrigin::Kind::assumed);
    // The assumption explains them already.
    EXPECT_EQ(timesOf(programOf({.acceleration = 4000, .jerk = 20})).limits[Limit::printing].kind,
              LimitOrigin::Kind::assumed);
}

TEST(ClockFit, LaterCommandsHold) {
    std::string program = programOf({.layers = 60});
    const auto middle = program.find(";LAYER:58");
    program.insert(middle, "M204 S5000\n");
    const PrintTimes times = timesOf(program);
    EXPECT_EQ(times.limits[Limit::printing].kind, LimitOrigin::Kind::fitted);
    EXPECT_EQ(times.limits[Limit::printing].changes, 1U);
    EXPECT_LT(times.layers[59] + times.layers[60], 0.9 * (times.layers[50] + times.layers[51]));
}

}  // namespace
}  // namespace stratum::motion
