#include "base/error.h"
#include "deposit/flow_recorder.h"
#include "deposit/read_print.h"
#include "motions.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace stratum::deposit {
namespace {

constexpr double kFilament = std::numbers::pi / 4 * 1.75 * 1.75;

// Two lines of 10 mm at this height, 0.2 mm high and 0.45 wide, with 30 mm of travel between them.
std::string twoTowers(double z, const char* before = "", const char* after = "", const char* below = "") {
    return fmt::format(
        "M83\nM204 P1000 T1000\nM205 X8 Y8\n{}\n;LAYER_CHANGE\n;Z:{}\n;HEIGHT:0.2\nG1 Z{} F600\nG1 X10 Y10 F9000\n"
        "G1 X20 Y10 E0.3387 F3600\n{}\nG1 X50 Y10 F9000\n{}\nG1 X60 Y10 E0.3387 F3600\n",
        below, z, z, before, after);
}

gcode::ReadOptions withStrings(double lag, double sag = 0) {
    gcode::ReadOptions options;
    options.deposit.flow_lag = lag;
    options.deposit.sag = sag;
    options.deposit.strings = true;
    return options;
}

PrintRead readStrings(const std::string& program, const gcode::ReadOptions& options) {
    return readPrint(program, "test.gcode", options, false);
}

std::vector<gcode::Bead> stringsOf(const gcode::Toolpath& toolpath) {
    std::vector<gcode::Bead> strings;
    for (const gcode::Bead& bead : toolpath.beads)
        if (bead.x0 > 19.9 && bead.x1 < 50.1 && bead.x1 > bead.x0) strings.push_back(bead);
    return strings;
}

void expectConserved(const PrintRead& print) {
    const FlowReport& flow = *print.flow;
    EXPECT_NEAR(flow.in_parts + flow.in_discs + flow.in_strings + flow.purged, flow.laid, 1e-9 * flow.fed);
    EXPECT_NEAR(flow.laid + flow.in_nozzle, flow.fed, 1e-9 * flow.fed);
    double sum = 0;
    for (const gcode::BeadFlow& one : print.toolpath.flow) sum += static_cast<double>(one.volume);
    EXPECT_NEAR(sum, flow.in_parts + flow.in_discs + flow.in_strings, 1e-6 * flow.fed);
}

void expectSameBeads(const gcode::Toolpath& one, const gcode::Toolpath& other) {
    ASSERT_EQ(one.beads.size(), other.beads.size());
    for (std::size_t n = 0; n < one.beads.size(); ++n) {
        EXPECT_NEAR(one.beads[n].x0, other.beads[n].x0, 1e-6) << n;
        EXPECT_NEAR(one.beads[n].x1, other.beads[n].x1, 1e-6) << n;
        EXPECT_EQ(one.beads[n].z0, other.beads[n].z0) << n;
        EXPECT_NEAR(one.beads[n].width, other.beads[n].width, 1e-6) << n;
    }
}

// The plan of a program, what is still pressed into the nozzle where its travel begins, and when that is.
struct Travelling {
    motion::PlanList plan;
    double pressure = 0;  // mm^3
    double begin = 0;     // s

    // mm/s
    double speedAt(double t) const {
        for (const motion::PlannedPiece& piece : plan.pieces) {
            const motion::Trapezoid& speed = piece.speed;
            const double in = t - piece.start;
            if (in > speed.seconds()) continue;
            if (in < speed.rising) return std::lerp(speed.entry, speed.peak, in / speed.rising);
            if (in < speed.rising + speed.cruising) return speed.peak;
            return std::lerp(speed.peak, speed.exit, (in - speed.rising - speed.cruising) / speed.falling);
        }
        return 0;
    }
};

Travelling travelOf(const std::string& program, double lag) {
    Travelling travel{.plan = motion::planOf(program)};
    bool printed = false;
    for (const motion::PlannedPiece& piece : travel.plan.pieces) {
        const bool prints = piece.segment.bead != gcode::Move::kNoBead;
        if (printed && !prints) {
            travel.begin = piece.start;
            break;
        }
        printed = prints;
        const double share = piece.segment.direction[3] * kFilament;
        const auto phase = [&](double seconds, double v0, double v1) {
            if (!(seconds > 0)) return;
            const double a = share * v0;
            const double b = share * (v1 - v0) / seconds;
            // lag P'= lag (a + b t) - P
            travel.pressure =
                lag * (a + b * (seconds - lag)) + (travel.pressure - lag * (a - b * lag)) * std::exp(-seconds / lag);
        };
        const motion::Trapezoid& speed = piece.speed;
        phase(speed.rising, speed.entry, speed.peak);
        phase(speed.cruising, speed.peak, speed.peak);
        phase(speed.falling, speed.peak, speed.exit);
    }
    return travel;
}

TEST(Strings, HaveTheVolumeOfTheExponential) {
    for (const double lag : {0.02, 0.1, 0.5}) {
        const std::string program = twoTowers(3);
        FlowRecorder recorder(lag, std::nullopt, 0.4, true);
        motion::Planner planner(recorder);
        gcode::ReadOptions options;
        options.motion = &planner;
        gcode::readToolpath(program, "test.gcode", options);
        planner.finish();
        const FlowRecord record = recorder.finish();
        const Travelling travel = travelOf(program, lag);
        ASSERT_GT(record.strings.size(), 4U) << lag;
        const auto left = [&](double t) { return travel.pressure * std::exp(-(t - travel.begin) / lag); };
        double sum = 0;
        for (const FlowString& piece : record.strings) {
            const double end = piece.start + piece.seconds;
            EXPECT_NEAR(piece.volume, left(piece.start) - left(end), 1e-9 * travel.pressure) << lag;
            sum += piece.volume;
            const double thick = piece.volume / (piece.to - piece.from);
            EXPECT_GE(2 * std::sqrt(thick / std::numbers::pi), kThinnestThread * (1 - 1e-9)) << lag;
            EXPECT_EQ(piece.z, 3);
            EXPECT_EQ(piece.y0, 10);
        }
        const FlowString& first = record.strings.front();
        const FlowString& last = record.strings.back();
        EXPECT_NEAR(sum, left(first.start) - left(last.start + last.seconds), 1e-9 * travel.pressure);
        // Its diameter where it begins and where it ends: that of the flow over the speed.
        for (const FlowString& piece : {first, last}) {
            const double middle = piece.start + 0.5 * piece.seconds;
            const double section = left(middle) / lag / travel.speedAt(middle);
            const double mean = piece.volume / (piece.to - piece.from);
            EXPECT_NEAR(std::sqrt(mean), std::sqrt(section), 0.03 * std::sqrt(section)) << lag;
        }
        EXPECT_NEAR(first.x0, 20.25, 0.3);
        const bool breaks = lag < 0.05;
        if (breaks) {
            // Where it is as thin as that.
            EXPECT_LT(last.x1, 40);
            const double end = last.start + last.seconds;
            const double section = left(end) / lag / travel.speedAt(end);
            EXPECT_NEAR(2 * std::sqrt(section / std::numbers::pi), kThinnestThread, 0.1 * kThinnestThread);
        } else {
            EXPECT_NEAR(last.x1, 49.75, 0.3) << lag;
        }
        for (const FlowString& piece : record.strings)
            EXPECT_NEAR(piece.span, breaks ? 0 : last.x1 - first.x0, 1e-9) << lag;
    }
}

TEST(Strings, LoseNothing) {
    for (const double lag : {0.02, 0.1, 0.5})
        for (const double sag : {0.0, 0.1}) {
            const PrintRead print = readStrings(twoTowers(3), withStrings(lag, sag));
            expectConserved(print);
            EXPECT_EQ(print.flow->strings, 1U);
            EXPECT_GT(print.flow->in_strings, 0);
            double volume = 0;
            for (const gcode::Bead& bead : stringsOf(print.toolpath)) volume += gcode::beadVolume(print.toolpath, bead);
            EXPECT_NEAR(volume, print.flow->in_strings, 1e-5 * print.flow->in_strings) << lag << " " << sag;
            // Strings move plastic and change no flow.
            gcode::ReadOptions without = withStrings(lag, sag);
            without.deposit.strings = false;
            const PrintRead plain = readStrings(twoTowers(3), without);
            EXPECT_EQ(plain.flow->strings, 0U);
            EXPECT_NEAR(plain.flow->laid, print.flow->laid, 1e-9 * plain.flow->fed);
            EXPECT_NEAR(plain.flow->in_nozzle, print.flow->in_nozzle, 1e-9 * plain.flow->fed);
            EXPECT_TRUE(stringsOf(plain.toolpath).empty());
        }
}

TEST(Strings, HangBetweenTheirEnds) {
    constexpr double kSag = 0.05;
    const PrintRead print = readStrings(twoTowers(3), withStrings(0.5, kSag));
    const std::vector<gcode::Bead> strings = stringsOf(print.toolpath);
    ASSERT_GT(strings.size(), 15U);
    const double span = strings.back().x1 - strings.front().x0;
    double lowest = 3;
    for (std::size_t n = 0; n < strings.size(); ++n) {
        const gcode::Bead& bead = strings[n];
        const double middle = 0.5 * (bead.x0 + bead.x1) - strings.front().x0;
        if (n > 0) {
            EXPECT_EQ(bead.z0, strings[n - 1].z1);
            EXPECT_NEAR(bead.x0, strings[n - 1].x1, 1e-9);
        }
        if (std::abs(middle - 0.5 * span) > span / 16) {
            if (middle < 0.5 * span)
                EXPECT_LT(bead.z1, bead.z0) << n;
            else
                EXPECT_GT(bead.z1, bead.z0) << n;
        }
        lowest = std::min(lowest, double{bead.z1});
    }
    EXPECT_EQ(strings.front().z0, 3);
    EXPECT_EQ(strings.back().z1, 3);
    EXPECT_NEAR(3 - lowest, kSag * span, 0.02 * kSag * span);
    // One that broke has nothing at its other end and stays straight.
    for (const gcode::Bead& bead : stringsOf(readStrings(twoTowers(3), withStrings(0.02, kSag)).toolpath))
        EXPECT_EQ(bead.z1, 3);
}

TEST(Strings, AreNotWhereNothingOozesOrPlasticIsBelow) {
    const auto none = [](const std::string& program, double lag) {
        gcode::ReadOptions options = withStrings(lag);
        const PrintRead with = readStrings(program, options);
        EXPECT_EQ(with.flow->strings, 0U);
        EXPECT_EQ(with.flow->in_strings, 0);
        expectConserved(with);
        options.deposit.strings = false;
        expectSameBeads(with.toolpath, readStrings(program, options).toolpath);
    };
    // All is drawn back.
    none(twoTowers(3, "G1 E-1 F1800", "G1 E1 F1800"), 0.1);
    // Over the bed.
    none(twoTowers(0.2), 0.1);
    // Over a line of the layer below, and of one 0.8 mm below.
    for (const char* z : {"2.8", "2.2"})
        none(twoTowers(3, "", "", fmt::format("G1 Z{} F600\nG1 X15 Y10 F9000\nG1 X55 Y10 E1.35 F3600", z).c_str()),
             0.1);
    // At the end of the program: nothing is printed behind it, so what oozes there may hang, but all of it is told.
    expectConserved(readStrings(twoTowers(3) + "G1 X100 Y10 F9000\nG1 X150 Y100\n", withStrings(0.5)));
}

TEST(Strings, FollowTravelsThatTurnAndHop) {
    const std::string turns = twoTowers(3, "G1 Z3.4 F600\nG1 X35 Y40 F9000", "G1 Z3 F600");
    const PrintRead print = readStrings(turns, withStrings(0.5));
    expectConserved(print);
    EXPECT_EQ(print.flow->strings, 1U);
    const double length = std::hypot(15, 30) * 2;
    EXPECT_NEAR(print.flow->strings_mm, length, 1);
    double highest = 0;
    for (const gcode::Bead& bead : print.toolpath.beads) highest = std::max(highest, double{bead.y1});
    EXPECT_EQ(highest, 40);
    // Timed: each bead has its time, in order.
    const PrintRead timed = readPrint(turns, "test.gcode", withStrings(0.5, 0.1), true);
    ASSERT_EQ(timed.toolpath.timing.size(), timed.toolpath.beads.size());
    for (std::size_t n = 1; n < timed.toolpath.timing.size(); ++n)
        EXPECT_GE(timed.toolpath.timing[n].start, timed.toolpath.timing[n - 1].start - 1e-6) << n;
}

TEST(Strings, AreTheSameEachTimeAndNeedALag) {
    const std::string program = twoTowers(3);
    const PrintRead one = readStrings(program, withStrings(0.1, 0.05));
    const PrintRead other = readStrings(program, withStrings(0.1, 0.05));
    ASSERT_EQ(one.toolpath.beads.size(), other.toolpath.beads.size());
    for (std::size_t n = 0; n < one.toolpath.beads.size(); ++n) {
        EXPECT_EQ(one.toolpath.beads[n].x0, other.toolpath.beads[n].x0);
        EXPECT_EQ(one.toolpath.beads[n].z1, other.toolpath.beads[n].z1);
        EXPECT_EQ(one.toolpath.beads[n].width, other.toolpath.beads[n].width);
    }
    gcode::ReadOptions options = withStrings(0.1);
    options.belt_angle = 45;
    EXPECT_THROW(readStrings(program, options), UsageError);
    EXPECT_THROW(readStrings(program, withStrings(0)), UsageError);
    options = {};
    options.deposit.strings = true;
    EXPECT_THROW(readStrings(program, options), UsageError);
}

}  // namespace
}  // namespace stratum::deposit
