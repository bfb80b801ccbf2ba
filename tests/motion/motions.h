// Small motions for the tests of this room, and plain checks of what a planner makes of them.
#pragma once

#include "gcode/reader.h"
#include "motion/planner.h"

#include <gtest/gtest.h>

#include <cmath>
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

inline gcode::Move straight(double x, double y, double z, double e, double speed) {
    gcode::Move move;
    move.delta = {x, y, z, e};
    move.speed = speed;
    return move;
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
