#include "voxelize/beads/growth.h"

namespace stratum::voxelize {
namespace {

// By selected bead: how much has passed when it is finished.
std::vector<double> passedBy(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, bool time) {
    std::vector<double> passed;
    passed.reserve(selection.size());
    const bool planned = time && !toolpath.timing.empty();
    double sum = 0;
    for (const std::uint32_t bead : selection) {
        if (planned) {
            const gcode::BeadTiming& timing = toolpath.timing[bead];
            sum = timing.start + static_cast<double>(timing.seconds) - toolpath.timing[selection.front()].start;
        } else {
            sum += time ? gcode::beadSeconds(toolpath, toolpath.beads[bead]) : gcode::laidVolume(toolpath, bead);
        }
        passed.push_back(sum);
    }
    return passed;
}

// The same, where each layer is 1. Layers are told by their order: those of the next part begin anew.
void countLayers(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                 std::vector<double>& passed) {
    const auto layerOf = [&](std::size_t n) { return toolpath.runs[toolpath.beads[selection[n]].run].layer; };
    double before = 0, layers = 0;
    for (std::size_t begin = 0; begin < passed.size();) {
        std::size_t end = begin + 1;
        while (end < passed.size() && layerOf(end) == layerOf(begin)) ++end;
        const double after = passed[end - 1];
        for (; begin < end; ++begin)
            passed[begin] =
                begin + 1 < end && after > before ? layers + (passed[begin] - before) / (after - before) : layers + 1;
        before = after;
        layers += 1;
    }
}

}  // namespace

std::vector<double> equalShares(std::size_t count) {
    std::vector<double> shares;
    shares.reserve(count);
    for (std::size_t step = 1; step <= count; ++step)
        shares.push_back(static_cast<double>(step) / static_cast<double>(count));
    return shares;
}

std::vector<std::uint32_t> growthMoments(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                         const Growth& growth) {
    bool finished_ones = growth.by != GrowthBy::volume;
    std::vector<double> passed = passedBy(toolpath, selection, finished_ones);
    if (finished_ones && !(passed.back() > 0)) {
        finished_ones = false;
        passed = passedBy(toolpath, selection, false);
    }
    if (growth.by == GrowthBy::layers) {
        finished_ones = true;
        countLayers(toolpath, selection, passed);
    }
    std::vector<std::uint32_t> moments;
    moments.reserve(growth.shares.size());
    std::size_t finished = 1;
    for (const double share : growth.shares) {
        // With the margins, half of twenty equal beads is ten, however the sum is rounded.
        const double now = passed.back() * share;
        const auto there = [&](std::size_t next) {
            return finished_ones ? passed[next] <= now * (1 + 1e-9) : passed[next - 1] < now * (1 - 1e-9);
        };
        while (finished < selection.size() && (share >= 1 || there(finished))) ++finished;
        moments.push_back(selection[finished - 1] + 1);
    }
    return moments;
}

}  // namespace stratum::voxelize
