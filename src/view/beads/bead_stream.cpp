#include "view/beads/bead_stream.h"

#include "base/error.h"
#include "gcode/toolpath/plan_path.h"
#include "view/asked/picture_plan.h"
#include "view/beads/bead_look.h"
#include "voxelize/beads/growth.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>
#include <utility>
#include <vector>

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

namespace {

using Json = nlohmann::json;

constexpr std::size_t kPart = 32768;  // texels: half a megabyte

template <typename Value>
std::vector<std::uint8_t> bytesOf(const std::vector<Value>& values) {
    std::vector<std::uint8_t> bytes(values.size() * sizeof(Value));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

}  // namespace

std::string whyNoBeads(const Document& document) {
    const GivenInput& given = document.given();
    if (given.objects.size() != 1) return "the input is not a print alone";
    if (!document.toolpath(0)) return "the input is no print, or was not read";
    if (!given.objects.front().placement.isIdentity()) return "the print is moved by its scene";
    const assemble::PrintRequest& request = given.options.tracing.prints;
    if (!request.print.layers.empty() || !request.print.features.empty() || !request.print.objects.empty() ||
        !request.print.tools.empty() || !request.printed.empty())
        return "the command line selects a part of the print";
    return {};
}

bool BeadStream::sendPart() {
    if (!table_ || generation_ != document_.generation()) {
        table_.reset();
        std::string why = whyNoBeads(document_);
        if (why.empty()) {
            try {
                table_ = std::make_unique<const BeadTable>(document_.toolpath(0));
            } catch (const InputError& error) {
                why = error.what();
            }
        }
        if (!why.empty()) {
            // Without parts, so that the page has something to acknowledge.
            output_.picture({{"type", "no-beads"}, {"text", why}}, {});
            return false;
        }
        generation_ = document_.generation();
        next_ = 0;
        // With another table the page forgets what it had of the one before.
        colors_key_.reset();
        light_key_.clear();
        Json head = table_->head();
        head["generation"] = generation_;
        output_.picture(head, bytesOf(table_->runs()));
        return true;
    }
    output_.picture({{"type", "bead-part"}, {"generation", generation_}}, bytesOf(table_->part(next_, kPart)));
    if (next_ < table_->beads()) return true;
    table_.reset();  // the page has it now
    return false;
}

void BeadStream::sendLook(const ViewedPicture& picture, const PicturePlan& plan, ViewScene& scene,
                          std::uint64_t number) {
    // A light that turns with the camera is turned by the page.
    const bool above = !picture.scene.bed || picture.scene.camera.eye().z > picture.scene.bed->z;
    const std::string light_key =
        fmt::format("{} {} {} {}", plan.light_key, plan.objects_key, above, document_.generation());
    const bool lights = light_key != light_key_;
    light_key_ = light_key;
    const auto& objects = scene.objects();
    const std::string by = objects.legends.size() == 1 ? objects.legends.front().title : std::string();
    // Ramps follow what is selected.
    const std::string colors_key =
        by.empty() ? std::string() : fmt::format("{} {}", plan.objects_key, document_.generation());
    if (colors_key_ != colors_key && objects.prints.size() == 1) {
        const auto& toolpath = objects.prints.front()->finest().layout().toolpath;
        BeadColors colors;
        if (!by.empty()) colors = colorsOf(picture, *toolpath, by);
        Json palette = Json::array();
        for (const shade::Color& color : colors.palette) palette.push_back({color.r, color.g, color.b});
        output_.picture({{"type", "colors"}, {"palette", std::move(palette)}, {"values", colors.values}},
                        bytesOf(colors.places));
        colors_key_ = colors_key;
    }
    Json look = lookOf(picture, plan, lights ? &scene.bareLight() : nullptr);
    look["number"] = number;
    look["command"] = shellLine(plan.words);
    output_.text(look);
}

}  // namespace stratum::view
