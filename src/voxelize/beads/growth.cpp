#include "voxelize/beads/growth.h"

namespace stratum::voxelize {
namespace {

// By selected bead: how much has passed when it is finished.
std::vector<double> passedBy(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, GrowthBy by) {
    std::vector<double> passed;
    passed.reserve(selection.size());
    const bool planned = by == GrowthBy::time && !toolpath.timing.empty();
    double sum = 0;
    for (const std::uint32_t bead : selection) {
        if (planned) {
            const gcode::BeadTiming& timing = toolpath.timing[bead];
            sum = timing.start + static_cast<double>(timing.seconds) - toolpath.timing[selection.front()].start;
        } else {
            sum += by == GrowthBy::time ? gcode::beadSeconds(toolpath, toolpath.beads[bead])
                                        : gcode::laidVolume(toolpath, bead);
        }
        passed.push_back(sum);
    }
    return passed;
}

}  // namespace

std::vector<std::uint32_t> growthMoments(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                         std::size_t count, GrowthBy by) {
    std::vector<double> passed = passedBy(toolpath, selection, by);
    if (!(passed.back() > 0)) {
        by = GrowthBy::volume;
        passed = passedBy(toolpath, selection, by);
    }
    std::vector<std::uint32_t> moments;
    moments.reserve(count);
    std::size_t finished = 1;
    for (std::size_t step = 1; step <= count; ++step) {
        // With the margins, half of twenty equal beads is ten, however the sum is rounded.
        const double now = passed.back() * (static_cast<double>(step) / static_cast<double>(count));
        const auto there = [&](std::size_t next) {
            return by == GrowthBy::time ? passed[next] <= now * (1 + 1e-9) : passed[next - 1] < now * (1 - 1e-9);
        };
        while (finished < selection.size() && (step == count || there(finished))) ++finished;
        moments.push_back(selection[finished - 1] + 1);
    }
    return moments;
}

}  // namespace stratum::voxelize
