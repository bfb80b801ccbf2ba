// Small motions for the tests of this room, and plain checks of what a planner makes of them.
#pragma once

#include "gcode/reader.h"
#include "motion/planner.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string_view>
#include <vector>

namespace stratum::motion {

/// What a planner said.
struct PlanList {
    struct Wait {
        double start;
        double seconds;
    };
    std::vector<PlannedPiece> pieces;
    std::vector<Wait> waits;
    double seconds = 0;
};

/// Keeps it.
class PlanKeeper : public PlanSink {
public:
    void piece(const PlannedPiece& piece) override { list.pieces.push_back(piece); }
    void wait(double start, double seconds) override { list.waits.push_back({start, seconds}); }

    PlanList list;
};

/// Reads and plans a program.
inline PlanList planOf(std::string_view program, gcode::CornerRule rule = gcode::CornerRule::automatic) {
    PlanKeeper keeper;
    Planner planner(keeper);
    gcode::ReadOptions options;
    options.motion = &planner;
    options.corner_rule = rule;
    gcode::readToolpath(program, "test.gcode", options);
    planner.finish();
    keeper.list.seconds = planner.seconds();
    return keeper.list;
}

/// Moves, all by the same limits.
struct Motions {
    gcode::MachineLimits limits;
    std::vector<gcode::Move> moves;
};

inline PlanList planned(const Motions& program) {
    PlanKeeper keeper;
    Planner planner(keeper);
    planner.limits(program.limits);
    for (const gcode::Move& move : program.moves) planner.move(move);
    planner.finish();
    keeper.list.seconds = planner.seconds();
    return keeper.list;
}

inline gcode::Move straight(double x, double y, double z, double e, double speed) {
    gcode::Move move;
    move.delta = {x, y, z, e};
    move.speed = speed;
    return move;
}

/// Short and long moves, sharp and soft corners, lifts and retractions.
inline Motions randomMotions(gcode::CornerRule rule, unsigned seed, int moves) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    Motions program;
    program.limits.rule = rule;
    program.limits.printing = program.limits.travel = std::pow(10, 2.5 + unit(random));
    double angle = 0;
    for (int i = 0; i < moves; ++i) {
        const double kind = unit(random);
        const double speed = std::pow(10, 1.5 + 0.8 * unit(random));
        if (kind > 0.95) {
            program.moves.push_back(straight(0, 0, 0, unit(random), speed));
        } else if (kind > 0.93) {
            program.moves.push_back(straight(0, 0, 0.2, 0, speed));
        } else {
            angle += kind > 0.7 ? 3 * unit(random) : 0.05 * unit(random);
            const double length = std::pow(10, unit(random) - (kind < -0.5 ? 1 : 0));
            program.moves.push_back(
                straight(length * std::cos(angle), length * std::sin(angle), 0, kind > 0.5 ? 0 : 0.04 * length, speed));
        }
    }
    return program;
}

/// The length that the speeds of a piece add up to: what its three phases cover.
inline double coveredBy(const Trapezoid& t) {
    return 0.5 * (t.entry + t.peak) * t.rising + t.peak * t.cruising + 0.5 * (t.peak + t.exit) * t.falling;
}

/// Every piece covers its length, no number is odd, and speeds stay within what was allowed.
inline void expectSound(const PlanList& plan) {
    double time = 0;
    for (const PlannedPiece& piece : plan.pieces) {
        const Trapezoid& t = piece.speed;
        ASSERT_TRUE(std::isfinite(t.seconds()) && t.seconds() >= 0) << "line " << piece.segment.line;
        ASSERT_GE(t.rising, 0);
        ASSERT_GE(t.cruising, 0);
        ASSERT_GE(t.falling, 0);
        ASSERT_GE(t.entry, 0);
        ASSERT_LE(t.peak, piece.segment.speed * (1 + 1e-9));
        ASSERT_NEAR(coveredBy(t), piece.segment.length, 1e-9 * (1 + piece.segment.length));
        ASSERT_GE(piece.start, time - 1e-9 * (1 + time));
        time = piece.start + t.seconds();
    }
}

}  // namespace stratum::motion
