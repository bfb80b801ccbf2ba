#include "view/beads/bead_table.h"

#include "base/error.h"
#include "gcode/toolpath/plan_path.h"
#include "voxelize/beads/growth.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

constexpr double kSteps = 65535;
constexpr double kWidthStep = 0.004;  // mm
constexpr std::uint32_t kMaxWidth = 4095, kExtra = 1U << 12, kRunBits = 13, kMaxRuns = 1U << 19;
constexpr std::size_t kMaxTexels = std::size_t{1} << 22;  // 64 MB on the page's GPU
constexpr std::size_t kMoments = 200;                     // half per cents

std::uint32_t bitsOf(double value) { return std::bit_cast<std::uint32_t>(static_cast<float>(value)); }

std::vector<std::uint32_t> wordsOf(const gcode::Toolpath& toolpath) {
    std::vector<std::uint32_t> words;
    words.reserve(4 * toolpath.runs.size());
    for (const gcode::Run& run : toolpath.runs) {
        const double height = std::round(static_cast<double>(run.height) * 1e6) * 1e-6;  // as voxelize::sectionOf()
        const double side = 0.5 * height - toolpath.deposit.cornerRadius(height);
        words.push_back(bitsOf(height));
        words.push_back(bitsOf(side > 1e-9 ? side : 0.0));
        words.push_back(run.layer);
        words.push_back(static_cast<std::uint32_t>(run.feature) | std::uint32_t{run.tool} << 8 |
                        std::uint32_t{run.object} << 16);
    }
    return words;
}

}  // namespace

BeadTable::BeadTable(std::shared_ptr<const gcode::Toolpath> toolpath) : toolpath_(std::move(toolpath)) {
    const gcode::Toolpath& print = *toolpath_;
    if (print.belt_angle != 0) throw InputError("the layers of a print on a belt lean; the server alone draws them");
    if (print.runs.size() > kMaxRuns)
        throw InputError(
            fmt::format("the print changes its features {} times; at most {} fit", print.runs.size(), kMaxRuns));
    std::array<double, 3> high{};
    low_.fill(1e300);
    high.fill(-1e300);
    for (const gcode::Bead& bead : print.beads) {
        const std::array<double, 6> ends{bead.x0, bead.y0, bead.z0, bead.x1, bead.y1, bead.z1};
        for (std::size_t n = 0; n < ends.size(); ++n) {
            low_[n % 3] = std::min(low_[n % 3], ends[n]);
            high[n % 3] = std::max(high[n % 3], ends[n]);
        }
        if (bead.arc >= 0) {  // it may reach beyond its ends
            double min[2], max[2];
            gcode::PlanPath(print, bead).bounds(min, max);
            for (std::size_t axis = 0; axis < 2; ++axis) {
                low_[axis] = std::min(low_[axis], min[axis]);
                high[axis] = std::max(high[axis], max[axis]);
            }
        }
        arcs_ = arcs_ || bead.arc >= 0;
        slopes_ = slopes_ || bead.z0 != bead.z1;
        tapers_ = tapers_ || gcode::widening(print, bead) != 0.0;
        texels_ += hasExtra(bead) ? 2 : 1;
        if (!(bead.width <= kMaxWidth * kWidthStep))
            throw InputError(fmt::format("line {}: a bead {:.1f} mm wide; at most {:.1f} mm fit", print.lineOf(bead),
                                         bead.width, kMaxWidth * kWidthStep));
    }
    if (texels_ > kMaxTexels) throw InputError(fmt::format("{} beads; at most {} fit", print.beads.size(), kMaxTexels));
    for (std::size_t axis = 0; axis < 3; ++axis) grain_[axis] = std::max((high[axis] - low_[axis]) / kSteps, 1e-9);
    runs_ = wordsOf(print);
    for (std::size_t n = 1; n < runs_.size(); n += 4) corners_ = corners_ || runs_[n] != 0;
    for (const gcode::Run& run : print.runs) runs_.push_back(bitsOf(run.speed));
}

bool BeadTable::hasExtra(const gcode::Bead& bead) const {
    return bead.arc >= 0 || gcode::widening(*toolpath_, bead) != 0.0;
}

std::uint32_t BeadTable::step(double mm, std::size_t axis) const {
    return static_cast<std::uint32_t>(std::clamp(std::round((mm - low_[axis]) / grain_[axis]), 0.0, kSteps));
}

Json BeadTable::head() const {
    Json features = Json::array();
    for (std::size_t n = 0; n < gcode::kFeatureCount; ++n)
        features.push_back(gcode::featureName(static_cast<gcode::Feature>(n)));
    Json objects = Json::array();
    for (const std::string& name : toolpath_->objects) objects.push_back(name.substr(0, 200));
    // As --printed has it: shares of the volume are those of the layers, without prime lines.
    std::vector<std::uint32_t> all(toolpath_->beads.size());
    std::iota(all.begin(), all.end(), 0U);
    std::vector<std::uint32_t> part;
    std::copy_if(all.begin(), all.end(), std::back_inserter(part),
                 [this](std::uint32_t bead) { return toolpath_->runOf(toolpath_->beads[bead]).layer > 0; });
    if (part.empty()) part = all;
    const std::vector<double> shares = voxelize::equalShares(kMoments);
    return {{"type", "beads"},
            {"beads", beads()},
            {"runs", toolpath_->runs.size()},
            {"low", low_},
            {"grain", grain_},
            {"kinds",
             {{"arcs", arcs_},
              {"tapers", tapers_},
              {"slopes", slopes_},
              {"corners", corners_},
              {"extras", arcs_ || tapers_}}},
            {"features", std::move(features)},
            {"objects", std::move(objects)},
            {"printed",
             {{"volume", voxelize::growthMoments(*toolpath_, part, {voxelize::GrowthBy::volume, shares})},
              {"time", voxelize::growthMoments(*toolpath_, all, {voxelize::GrowthBy::time, shares})}}}};
}

std::vector<std::uint32_t> BeadTable::part(std::size_t& bead, std::size_t count) const {
    const gcode::Toolpath& print = *toolpath_;
    std::vector<std::uint32_t> words;
    words.reserve(4 * count + 4);
    for (; bead < print.beads.size() && words.size() < 4 * count; ++bead) {
        const gcode::Bead& b = print.beads[bead];
        const bool extra = hasExtra(b);
        words.push_back(step(b.x0, 0) | step(b.y0, 1) << 16);
        words.push_back(step(b.x1, 0) | step(b.y1, 1) << 16);
        words.push_back(step(b.z0, 2) | step(b.z1, 2) << 16);
        words.push_back(static_cast<std::uint32_t>(std::lround(static_cast<double>(b.width) / kWidthStep)) |
                        (extra ? kExtra : 0U) | b.run << kRunBits);
        if (!extra) continue;
        const gcode::Arc arc = b.arc >= 0 ? print.arcs[static_cast<std::size_t>(b.arc)] : gcode::Arc{};
        words.push_back(bitsOf(arc.center_x - low_[0]));
        words.push_back(bitsOf(arc.center_y - low_[1]));
        words.push_back(bitsOf(arc.sweep));
        words.push_back(bitsOf(b.arc >= 0 || b.z0 != b.z1 ? 0.0 : gcode::widening(print, b)));
    }
    return words;
}

}  // namespace stratum::view
