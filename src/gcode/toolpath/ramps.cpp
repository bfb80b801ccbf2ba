#include "gcode/toolpath/ramps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr double kRampLevel = 1e-6;           // mm; rounding of relative moves
constexpr double kThinnestRamp = 0.01;        // mm
constexpr double kRampSlack = 0.02;           // mm, that a ramp may begin below the layer below
constexpr double kClearlyBetter = 0.5;        // of the misfit of the widths
constexpr double kClearlyThin = 0.97;         // of the wall's width: narrower beads may lie above a ramp
constexpr double kSameRamp = 0.1;             // mm between the middle of such a bead and the ramp
constexpr std::size_t kMostRampPieces = 256;  // of a ramp that are searched: a bound for damaged files

bool isSloped(const Bead& bead) { return std::abs(bead.z1 - bead.z0) > kRampLevel; }

double sectionOfBead(const Bead& bead) { return static_cast<double>(bead.width); }

double misfit(double width, double expected) { return std::abs(std::log(width / expected)); }

class RampSplitter {
public:
    explicit RampSplitter(Toolpath& toolpath) : toolpath_(toolpath), heights_(toolpath.beads.size()) {}

    void run() {
        const std::vector<Bead>& beads = toolpath_.beads;
        for (std::size_t n = 0; n < beads.size();) {
            if (!isSloped(beads[n])) {
                closeGap(n++);
                continue;
            }
            std::size_t end = n;
            while (end < beads.size() && isSloped(beads[end]) && alike(end, n)) ++end;
            takeRamp(n, end);
            n = end;
        }
        rebuildRuns();
    }

private:
    const Run& runOf(std::size_t n) const { return toolpath_.runOf(toolpath_.beads[n]); }

    bool alike(std::size_t n, std::size_t first) const {
        const Run& a = runOf(n);
        const Run& b = runOf(first);
        return a.layer == b.layer && a.tool == b.tool && a.object == b.object && a.height == b.height;
    }

    // Width of the level bead of the same layer next to [first, end).
    std::optional<double> wallWidth(std::size_t first, std::size_t end) const {
        const auto width = [&](std::size_t n) -> std::optional<double> {
            if (n >= toolpath_.beads.size() || isSloped(toolpath_.beads[n]) || !alike(n, first)) return std::nullopt;
            return sectionWidth(sectionOfBead(toolpath_.beads[n]), static_cast<double>(runOf(n).height));
        };
        const auto behind = width(end);
        return behind || first == 0 ? behind : width(first - 1);
    }

    void takeRamp(std::size_t first, std::size_t end) {
        ramp_.clear();
        const auto full = static_cast<double>(runOf(first).height);
        double top = -1e9;
        double low = 1e9;
        for (std::size_t n = first; n < end; ++n) {
            const Bead& bead = toolpath_.beads[n];
            top = std::max({top, +bead.z0, +bead.z1});
            low = std::min({low, +bead.z0, +bead.z1});
        }
        const double base = top - full;
        if (low < base - kRampSlack || runOf(first).layer == 0) return;
        const auto height = [&](std::size_t n) {
            const Bead& bead = toolpath_.beads[n];
            return std::max(0.5 * (bead.z0 + bead.z1) - base, kThinnestRamp);
        };
        std::vector<std::pair<double, double>> widths;  // as a ramp, as a layer
        for (std::size_t n = first; n < end; ++n)
            widths.emplace_back(sectionWidth(sectionOfBead(toolpath_.beads[n]), height(n)),
                                sectionWidth(sectionOfBead(toolpath_.beads[n]), full));
        const std::optional<double> wall = wallWidth(first, end);
        const auto total = [&](auto member) {
            double expected = wall.value_or(0);
            if (!wall) {
                for (const auto& pair : widths) expected += member(pair);
                expected /= static_cast<double>(widths.size());
            }
            double sum = 0;
            for (const auto& pair : widths) sum += misfit(member(pair), expected);
            return sum;
        };
        const auto as_ramp = [](const std::pair<double, double>& pair) { return pair.first; };
        const auto as_layer = [](const std::pair<double, double>& pair) { return pair.second; };
        if (!(total(as_ramp) < kClearlyBetter * total(as_layer))) return;
        for (std::size_t n = first; n < end; ++n) heights_[n] = static_cast<float>(height(n));
        changed_ = true;
        if (!wall) return;
        ramp_wall_ = *wall;
        for (std::size_t n = first; n < std::min(end, first + kMostRampPieces); ++n) ramp_.push_back(n);
    }

    // The z of the ramp below the middle of a bead.
    std::optional<double> rampBelow(const Bead& bead) const {
        const double x = 0.5 * (bead.x0 + bead.x1);
        const double y = 0.5 * (bead.y0 + bead.y1);
        std::optional<double> found;
        double nearest = kSameRamp;
        for (const std::size_t n : ramp_) {
            const Bead& piece = toolpath_.beads[n];
            const double dx = piece.x1 - piece.x0;
            const double dy = piece.y1 - piece.y0;
            const double length2 = dx * dx + dy * dy;
            const double t =
                length2 > 0 ? std::clamp(((x - piece.x0) * dx + (y - piece.y0) * dy) / length2, 0.0, 1.0) : 0;
            const double distance = std::hypot(x - piece.x0 - t * dx, y - piece.y0 - t * dy);
            if (!(distance < nearest)) continue;
            nearest = distance;
            found = std::lerp(+piece.z0, +piece.z1, t);
        }
        return found;
    }

    void closeGap(std::size_t n) {
        if (ramp_.empty()) return;
        if (!alike(n, ramp_.front())) return ramp_.clear();
        const Bead& bead = toolpath_.beads[n];
        const double width = sectionWidth(sectionOfBead(bead), static_cast<double>(runOf(n).height));
        if (!(width < kClearlyThin * ramp_wall_)) return;
        const std::optional<double> below = rampBelow(bead);
        if (!below) return;
        const double gap = std::max(bead.z1 - *below, kThinnestRamp);
        if (misfit(sectionWidth(sectionOfBead(bead), gap), ramp_wall_) < misfit(width, ramp_wall_))
            heights_[n] = static_cast<float>(gap);
    }

    void rebuildRuns() {
        if (!changed_) return;
        std::vector<Run> runs;
        std::uint32_t before = 0;
        for (std::size_t n = 0; n < toolpath_.beads.size(); ++n) {
            Bead& bead = toolpath_.beads[n];
            Run run = toolpath_.runs[bead.run];
            if (heights_[n] > 0) run.height = std::round(heights_[n] * 1000) / 1000;
            if (runs.empty() || bead.run != before || !(runs.back() == run)) runs.push_back(run);
            before = bead.run;
            bead.run = static_cast<std::uint32_t>(runs.size() - 1);
        }
        toolpath_.runs = std::move(runs);
    }

    Toolpath& toolpath_;
    std::vector<float> heights_;  // by bead; 0: that of its run
    bool changed_ = false;
    std::vector<std::size_t> ramp_;  // beads of the last one in this layer
    double ramp_wall_ = 0;           // width of its wall
};

}  // namespace

void splitRamps(Toolpath& toolpath) {
    if (std::any_of(toolpath.beads.begin(), toolpath.beads.end(), isSloped)) RampSplitter(toolpath).run();
}

}  // namespace stratum::gcode
