#include "motion/travels.h"

#include <cmath>

namespace stratum::motion {
namespace {

constexpr double kStandstill = 1e-9;  // mm

}  // namespace

void TravelRecorder::move(const gcode::Move& move) {
    gcode::Move passed = move;
    const auto& d = move.delta;
    if (move.bead != gcode::Move::kNoBead) {
        beads_ = move.bead + 1;
    } else if (move.sweep != 0 || std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) > kStandstill) {
        passed.travel = static_cast<std::uint32_t>(travels_.size());
        Travel travel;
        travel.x0 = move.start[0], travel.y0 = move.start[1], travel.z0 = move.start[2];
        travel.x1 = move.start[0] + d[0], travel.y1 = move.start[1] + d[1], travel.z1 = move.start[2] + d[2];
        if (move.sweep != 0) {
            travel.center_x = move.start[0] + move.center.x;
            travel.center_y = move.start[1] + move.center.y;
            travel.sweep = static_cast<float>(move.sweep);
        }
        travel.speed = static_cast<float>(move.speed);
        travel.filament = static_cast<float>(d[3]);
        travel.bead = beads_;
        travel.line = move.line;
        travels_.push_back(travel);
    }
    if (next_ != nullptr) next_->move(passed);
}

}  // namespace stratum::motion
