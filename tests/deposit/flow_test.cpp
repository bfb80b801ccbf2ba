#include "base/input_file.h"
#include "corpus.h"
#include "deposit/flow_recorder.h"
#include "deposit/read_print.h"
#include "motions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace stratum::deposit {
namespace {

constexpr double kFilament = std::numbers::pi / 4 * 1.75 * 1.75;

gcode::ReadOptions withLag(double lag, std::optional<double> advance = std::nullopt) {
    gcode::ReadOptions options;
    options.deposit.flow_lag = lag;
    options.deposit.pressure_advance = advance;
    return options;
}

PrintRead readText(const std::string& program, const gcode::ReadOptions& options) {
    return readPrint(program, "test.gcode", options, false);
}

// An L of two lines, 20 mm each, 0.2 mm high and 0.45 wide, at 60 mm/s. E of a line: 20 * 0.0814 / 2.405. Retracts 1 mm
// and primes this much.
std::string corner(const char* prime) {
    return fmt::format(
        "M83\nM204 P1000 T1000\nM205 X8 Y8\n;LAYER_CHANGE\n;Z:0.2\n;HEIGHT:0.2\nG1 Z0.2 F3600\nG1 X5 Y5 E-1\n"
        "G1 X10 Y10\nG1 E{} F1800\nG1 X30 Y10 E0.677 F3600\nG1 X30 Y30 E0.677\nG1 E-1 F1800\nG1 X0 Y0 F9000\n",
        prime);
}
const std::string kCorner = corner("1.2");

double sumOf(const gcode::Toolpath& toolpath) {
    double sum = 0;
    for (const gcode::BeadFlow& flow : toolpath.flow) sum += static_cast<double>(flow.volume);
    return sum;
}

void expectSound(const PrintRead& print) {
    const gcode::Toolpath& toolpath = print.toolpath;
    ASSERT_EQ(toolpath.flow.size(), toolpath.beads.size());
    for (std::size_t n = 0; n < toolpath.beads.size(); ++n) {
        const gcode::Bead& bead = toolpath.beads[n];
        const auto width = static_cast<double>(bead.width);
        const auto widening = static_cast<double>(toolpath.flow[n].widening);
        ASSERT_TRUE(std::isfinite(width) && width > 0) << n;
        ASSERT_LE(std::abs(widening), gcode::beadLength(toolpath, bead) * (1 + 1e-6)) << n;
        if (widening != 0) {
            ASSERT_GE(width - std::abs(widening) / 2, static_cast<double>(toolpath.runOf(bead).height) * (1 - 1e-6));
        }
    }
    const FlowReport& report = *print.flow;
    EXPECT_NEAR(report.in_parts + report.in_discs + report.purged, report.laid, 1e-9 * report.fed);
    EXPECT_NEAR(report.laid + report.in_nozzle, report.fed, 1e-9 * report.fed);
    EXPECT_NEAR(sumOf(toolpath), report.in_parts + report.in_discs, 1e-6 * report.fed);
}

TEST(Flow, WithoutLagBeadsKeepTheirWidths) {
    const PrintRead print = readText(kCorner, withLag(0));
    const gcode::Toolpath plain = gcode::readToolpath(kCorner, "test.gcode");
    expectSound(print);
    // The prime before the first line is more than was retracted: a disc.
    ASSERT_EQ(print.toolpath.beads.size(), 3U);
    EXPECT_NEAR(static_cast<double>(print.toolpath.flow[0].volume), 0.2 * kFilament, 1e-6);
    for (int n = 0; n < 2; ++n) {
        EXPECT_FLOAT_EQ(print.toolpath.beads[n + 1].width, plain.beads[n].width);
        EXPECT_EQ(print.toolpath.flow[n + 1].widening, 0);
    }
    EXPECT_NEAR(print.flow->fed, 1.554 * kFilament, 1e-9);
    EXPECT_NEAR(print.flow->in_nozzle, 0, 1e-9);
}

TEST(Flow, AdvanceOfTheSameTimeCancelsTheLag) {
    // Primes what was retracted, no more.
    const std::string program = corner("1");
    const PrintRead print = readText(program, withLag(0.05, 0.05));
    const gcode::Toolpath plain = gcode::readToolpath(program, "test.gcode");
    expectSound(print);
    EXPECT_EQ(print.flow->parts, 2U);
    EXPECT_EQ(print.flow->discs, 0U);
    for (const gcode::Bead& bead : print.toolpath.beads)
        EXPECT_NEAR(bead.width, plain.beads[0].width, 1e-4 * static_cast<double>(plain.beads[0].width));
    // The same advance from the file.
    for (const char* command : {"M900 K0.05\n", "M572 D0 S0.05\n", "SET_PRESSURE_ADVANCE ADVANCE=0.05\n"}) {
        const PrintRead file = readText(command + program, withLag(0.05));
        EXPECT_EQ(file.flow->longest_advance, 0.05);
        EXPECT_EQ(file.flow->parts, 2U);
    }
    // One that is no time is ignored, with a warning.
    const PrintRead other = readText("M900 K100\n" + program, withLag(0.05));
    EXPECT_EQ(other.flow->longest_advance, 0);
    ASSERT_FALSE(other.toolpath.warnings.empty());
    EXPECT_NE(other.toolpath.warnings[0].text.find("M900 K100 is no pressure advance"), std::string::npos);
}

TEST(Flow, CornersBulgeAndStartsAreThin) {
    const PrintRead print = readText(kCorner, withLag(0.05));
    expectSound(print);
    const gcode::Toolpath plain = gcode::readToolpath(kCorner, "test.gcode");
    const auto commanded = static_cast<double>(plain.beads[0].width);
    double corner = 0;
    double after = 1e9;
    for (std::size_t n = 0; n < print.toolpath.beads.size(); ++n) {
        const gcode::Bead& bead = print.toolpath.beads[n];
        if (bead.x1 > 29.5 && bead.y1 == 10) corner = std::max(corner, static_cast<double>(bead.width));
        if (bead.x0 == 30 && bead.y0 > 11 && bead.y1 < 16) after = std::min(after, static_cast<double>(bead.width));
    }
    EXPECT_GT(corner, 1.2 * commanded);
    EXPECT_LT(after, 0.95 * commanded);
    EXPECT_GT(print.flow->parts, 6U);
}

// The same by small steps of time through the whole plan.
TEST(Flow, AgreesWithStepsOfTime) {
    for (const double lag : {0.01, 0.05, 0.4})
        for (const double advance : {0.0, 0.02, 0.1}) {
            motion::PlanKeeper keeper;
            motion::Planner planner(keeper);
            gcode::ReadOptions options;
            options.motion = &planner;
            gcode::readToolpath(kCorner, "test.gcode", options);
            planner.finish();
            double extruder = 0;  // mm^3, advance included
            double left = 0;
            double fed = 0;
            constexpr double kStep = 1e-6;
            for (const motion::PlannedPiece& piece : keeper.list.pieces) {
                const motion::Trapezoid& speed = piece.speed;
                const double share = piece.segment.direction[3] * kFilament;
                const bool prints = piece.segment.bead != gcode::Move::kNoBead;
                for (double t = 0; t < speed.seconds(); t += kStep) {
                    double v = speed.peak;
                    if (t < speed.rising) v = std::lerp(speed.entry, speed.peak, t / speed.rising);
                    if (t > speed.rising + speed.cruising)
                        v = std::lerp(speed.peak, speed.exit, (t - speed.rising - speed.cruising) / speed.falling);
                    fed += share * v * kStep;
                    extruder = fed + (prints ? advance * share * v : 0);
                    left += std::max(extruder - left, 0.0) * kStep / lag;
                }
            }
            const PrintRead print = readText(kCorner, withLag(lag, advance));
            expectSound(print);
            EXPECT_NEAR(print.flow->laid, left, 1e-3) << lag << " " << advance;
        }
}

TEST(Flow, RetractionStopsTheFlowAndNothingIsLost) {
    // Retracts 1 mm and primes 1.2 mm at each of five restarts: 0.2 mm are left at each.
    std::string program = "M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z0.2 F3600\nG1 X10 Y10\n";
    for (int n = 0; n < 5; ++n) {
        const std::string y = std::to_string(10 + 2 * n);
        program += "G1 X10 Y" + y + " F9000\nG1 E1.2 F1800\nG1 X30 Y" + y + " E0.677 F3600\nG1 E-1 F1800\n";
    }
    const PrintRead print = readText(program, withLag(0));
    expectSound(print);
    EXPECT_EQ(print.flow->discs, 5U);
    EXPECT_NEAR(print.flow->in_discs, (1.2 + 4 * 0.2) * kFilament, 1e-9);
    EXPECT_NEAR(print.flow->in_parts, 5 * 0.677 * kFilament, 1e-9);
    const PrintRead lagging = readText(program, withLag(0.03));
    expectSound(lagging);
    EXPECT_NEAR(lagging.flow->laid, print.flow->laid, 0.05 * print.flow->laid);
}

TEST(Flow, ADiscAddsItsAreaBesideThePath) {
    for (const double half : {0.0, 0.1, 0.2, 0.5})
        for (const double area : {1e-6, 0.001, 0.05, 1.0})
            for (const bool inside : {false, true}) {
                const double radius = discRadius(half, area, inside);
                ASSERT_GE(radius, half);
                // The disc, cut into strips along the path: what lies outside |y| < half and, of a path that ends at
                // x = 0, outside the disc of its end.
                double sum = 0;
                const int strips = 20000;
                for (int n = 0; n < strips; ++n) {
                    const double y = radius * (n + 0.5) / strips;
                    const double chord = std::sqrt(radius * radius - y * y);
                    const double end = y < half ? std::sqrt(half * half - y * y) : 0;
                    const double strip = radius / strips;
                    if (y >= half)
                        sum += 2 * 2 * chord * strip;
                    else if (!inside)
                        sum += 2 * (chord - end) * strip;
                }
                EXPECT_NEAR(sum, area, 2e-3 * area + 1e-4 * radius * radius) << half << " " << area << " " << inside;
            }
}

TEST(Flow, ExtremesStayFinite) {
    for (const double lag : {0.0, 1e-9, 1e-3, 10.0, 1e6})
        for (const char* limits :
             {"", "M205 X0 Y0 E0\n", "M201 X1e-3 Y1e-3\nM204 P0 T0\n", "M204 P1e9 T1e9\nM205 X1e4 Y1e4\n"})
            for (const double advance : {0.0, 5.0}) expectSound(readText(limits + kCorner, withLag(lag, advance)));
    // A path back and forth on itself, and beads without length.
    std::string program = "M83\n;LAYER_CHANGE\n;HEIGHT:0.2\nG1 Z0.2 F3600\n";
    for (int n = 0; n < 50; ++n) program += "G1 X10 E0.01\nG1 X10.0000001 E0.01\nG1 X10 E0.01\nG1 X10.2 E.02\nG4 P10\n";
    for (const double lag : {0.0, 0.05, 2.0}) expectSound(readText(program, withLag(lag)));
}

TEST(Flow, ExtremeProgramsKeepTheirPlastic) {
    // Retracts and primes after every millimetre; moves of a micrometre; primes what was never retracted, and rests.
    std::string stringing = "M83\nG1 Z0.2 F600\n";
    for (int n = 0; n < 1000; ++n)
        stringing +=
            fmt::format("G1 X{} E0.03 F1800\nG1 E-0.8 F2400\nG1 X{} F9000\nG1 E0.8 F2400\n", 2 * n + 1, 2 * n + 2);
    std::string micrometres = "M83\nG1 Z0.2 F600\nG1 X10 E0.3 F1800\n";
    for (int n = 1; n <= 2000; ++n) micrometres += fmt::format("G1 X{:.3f} E0.00003\n", 10 + 1e-3 * n);
    const std::string priming =
        "M83\nG1 Z0.2 F600\nG1 X10 E0.3 F1800\nG1 E5 F300\nG4 S2\nG1 X20 E0.3\nG1 E-20 F2400\nG1 X30 E0.3\n";
    for (const std::string& program : {stringing, micrometres + "G1 X30 E0.6\n", priming})
        for (const double lag : {0.0, 1e-6, 0.04, 10.0}) expectSound(readText(program, withLag(lag)));
}

// A damaged amount of E: without a bound the parts of a millimetre would be metres wide.
TEST(Flow, PartsAreNoWiderThanAHundredHeights) {
    gcode::ReadOptions options;
    options.deposit.flow_lag = 0.05;
    const std::string text =
        "M83\n;LAYER_CHANGE\n;Z:0.2\n;HEIGHT:0.2\nG1 Z.2 F600\nG1 X10 Y10\nG1 X20 E.5 F1200\nG1 Y11 E1269\nG1 X10 "
        "E.5\n";
    const PrintRead print = readPrint(text, "blob.gcode", options, false);
    EXPECT_FALSE(print.toolpath.empty());
    for (const gcode::Bead& bead : print.toolpath.beads) EXPECT_LE(bead.width, 20.001F);
    EXPECT_NEAR(print.flow->purged + print.flow->in_parts + print.flow->in_discs, print.flow->laid,
                1e-3 * print.flow->laid);
}

TEST(Flow, ThePrintsOfTheProjectKeepTheirPlastic) {
    for (const char* name :
         {"hull.gcode", "gear.gcode", "bridges.gcode", "two_tone.gcode", "vase.gcode", "knot.gcode"}) {
        const auto path = test::dataDir() / "gcode" / name;
        const InputFile file(path);
        for (const double lag : {0.0, 0.03}) {
            const PrintRead print = readPrint(file.bytes(), name, withLag(lag), true);
            expectSound(print);
            const FlowReport& flow = *print.flow;
            std::printf(
                "  %s, lag %g s: %zu beads, %zu parts, %zu discs; fed %.3f, laid %.3f, discs %.3f, purged %.3f, in "
                "nozzle %.3f mm3\n",
                name, lag, flow.beads, flow.parts, flow.discs, flow.fed, flow.laid, flow.in_discs, flow.purged,
                flow.in_nozzle);
            EXPECT_EQ(print.toolpath.timing.size(), print.toolpath.beads.size());
            EXPECT_NEAR(flow.laid, print.toolpath.extruded_mm3, 0.01 * flow.fed) << name;
        }
    }
}

}  // namespace
}  // namespace stratum::deposit
