#include "motion/marlin_look_ahead.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {
namespace {

constexpr std::size_t kQueued = 14;  // of 16 places: one is kept empty, and one is taken only when a block has left

}  // namespace

void MarlinLookAhead::add(const Segment& segment, const gcode::MachineLimits& limits) {
    const auto block = blocks_.next(segment, limits, count_ == 0);
    if (!block) {
        short_.push_back(segment);
        ++waiting_;
        return;
    }
    if (count_ == 0) entry_ = block->entry_most;
    Queued& last = at(count_);
    last.block = *block;
    last.segment = segment;
    last.merged = waiting_;
    waiting_ = 0;
    if (++count_ > kQueued) settleFirst();
}

double MarlinLookAhead::secondEntry() {
    // No more than the first block can reach, no more than allows to meet all later corners and the end.
    double most = entry_ + at(0).block.gain();
    double gains = 0;
    for (std::size_t i = 1; i < count_ && gains < most; ++i) {
        most = std::min(most, at(i).block.entry_most + gains);
        gains += at(i).block.gain();
    }
    return std::min(most, at(count_ - 1).block.last_exit + gains);
}

void MarlinLookAhead::settleFirst() {
    Queued& now = at(0);
    const double exit = count_ > 1 ? secondEntry() : now.block.last_exit;
    const Trapezoid profile = now.block.between(entry_, exit);
    now.segment.speed = std::max(now.block.speed, profile.peak);  // rates are whole steps a second
    now.segment.acceleration = now.block.acceleration;
    if (now.merged > 0) {
        settleMerged(now, profile);
    } else {
        now.segment.length = now.block.length;
        sink_.settled(now.segment, profile);
    }
    entry_ = exit;
    first_ = (first_ + 1) % queue_.size();
    --count_;
}

void MarlinLookAhead::settleMerged(const Queued& now, const Trapezoid& profile) {
    // Each has its share of the block.
    const auto last = short_.begin() + static_cast<std::ptrdiff_t>(now.merged);
    double whole = now.segment.length;
    for (auto segment = short_.begin(); segment != last; ++segment) whole += segment->length;
    double from = 0;
    const auto settle = [&](Segment segment) {
        segment.speed = std::max(now.block.speed, profile.peak);
        segment.acceleration = now.block.acceleration;
        segment.length *= now.block.length / whole;
        const double to = from + segment.length;
        sink_.settled(segment, partOf(profile, from, to));
        from = to;
    };
    std::for_each(short_.begin(), last, settle);
    settle(now.segment);
    short_.erase(short_.begin(), last);
}

void MarlinLookAhead::stop() {
    while (count_ > 0) settleFirst();
}

}  // namespace stratum::motion
