// The moves of a program that lay nothing.
#pragma once

#include "gcode/printer/motion.h"

#include <cstdint>
#include <vector>

namespace stratum::motion {

/// A move of the nozzle without a bead. Records have no padding.
struct Travel {
    double x0 = 0, y0 = 0, z0 = 0;      ///< mm, start
    double x1 = 0, y1 = 0, z1 = 0;      ///< mm, end
    double center_x = 0, center_y = 0;  ///< mm, of an arc
    double start = 0;                   ///< s since the program's begin; 0 unless its motion is planned
    float sweep = 0;                    ///< radians, counter-clockwise positive; 0: straight
    float seconds = 0;                  ///< that it takes; 0 unless its motion is planned
    float speed = 0;                    ///< mm/s, programmed
    float filament = 0;                 ///< mm of filament that E moves meanwhile; negative: it is drawn back
    std::uint32_t bead = 0;             ///< index of the next bead: the number of those that are laid before
    std::uint32_t line = 0;             ///< 1-based line in the source
};
static_assert(sizeof(Travel) == 96);

/// Records the travels of a program that is being read. All that it receives goes on to `next`, if that is not null:
/// to a planner, whose pieces of travels then have their indices in Segment::travel.
class TravelRecorder final : public gcode::MotionSink {
public:
    TravelRecorder(std::vector<Travel>& travels, gcode::MotionSink* next) : travels_(travels), next_(next) {}

    void limits(const gcode::MachineLimits& limits) override {
        if (next_ != nullptr) next_->limits(limits);
    }
    void move(const gcode::Move& move) override;
    void wait(double seconds) override {
        if (next_ != nullptr) next_->wait(seconds);
    }
    void stop(gcode::Stop kind, std::uint32_t line) override {
        if (next_ != nullptr) next_->stop(kind, line);
    }
    void elapsed(double seconds) override {
        if (next_ != nullptr) next_->elapsed(seconds);
    }
    void origin(const gcode::LimitOrigins& origins) override {
        if (next_ != nullptr) next_->origin(origins);
    }

private:
    std::vector<Travel>& travels_;
    gcode::MotionSink* const next_;
    std::uint32_t beads_ = 0;
};

}  // namespace stratum::motion
