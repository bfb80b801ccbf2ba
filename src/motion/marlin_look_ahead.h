// Marlin 2's queue of 16 blocks: a corner's speed is final when the block before it begins to move.
// Sources: Marlin 2.1.2.5, Marlin/src/module/planner.cpp (reverse_pass, forward_pass, get_current_block); the host is
// taken to be never late, so that the queue is full until the machine has to stop.
#pragma once

#include "motion/look_ahead.h"
#include "motion/marlin_block.h"

#include <array>
#include <cstddef>
#include <vector>

namespace stratum::motion {

class MarlinLookAhead : public LookAhead {
public:
    /// The sink must outlive it.
    explicit MarlinLookAhead(SettledSink& sink) : sink_(sink) {}

    void add(const Segment& segment, const gcode::MachineLimits& limits) override;
    void stop() override;

private:
    struct Queued {
        MarlinBlock block;
        Segment segment;
        std::size_t merged = 0;  // short segments that were merged into it
    };

    Queued& at(std::size_t place) { return queue_[(first_ + place) % queue_.size()]; }
    /// The speed, squared, at the begin of the second block, by what is known.
    double secondEntry();
    void settleFirst();
    void settleMerged(const Queued& now, const Trapezoid& profile);

    SettledSink& sink_;
    MarlinBlocks blocks_;
    std::vector<Segment> short_;  // those merged into blocks of the queue, then those that wait for a block
    std::size_t waiting_ = 0;     // of these
    std::array<Queued, 16> queue_;
    std::size_t first_ = 0;
    std::size_t count_ = 0;
    double entry_ = 0;  // of the first block, squared: final
};

}  // namespace stratum::motion
