#include "gcode/machine/bead_recorder.h"

#include "gcode/printer/machine_limits.h"
#include "gcode/slicer/feature_names.h"
#include "gcode/toolpath/color.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

// One that repeats what holds changes nothing.
void setFrom(std::vector<SetValue>& values, SetValue value) {
    if (values.empty() || values.back().tool != value.tool || values.back().value != value.value)
        values.push_back(value);
}

// What a damaged coordinate makes of a line: hundreds of thousands of voxels around next to nothing.
constexpr double kLong = 1000;             // mm
constexpr double kFinestSection = 3.1e-4;  // mm^2
constexpr double kSameLevel = 0.005;       // mm; less is no other layer
constexpr double kSameZ = 1e-6;            // mm; rounding of relative moves, far below the precision of files
constexpr std::size_t kMostPrimeBeads = 100;

}  // namespace

BeadRecorder::BeadRecorder(double nominal_height, std::size_t expected_beads, WarningLog& warnings)
    : nominal_height_(nominal_height), warnings_(warnings) {
    toolpath_.beads.reserve(expected_beads);
}

void BeadRecorder::tag(const Tag& tag, std::uint32_t line) {
    switch (tag.kind) {
        case Tag::Kind::none:
        case Tag::Kind::filament_loaded:
        case Tag::Kind::flush_start:
        case Tag::Kind::flush_stop:
        case Tag::Kind::units_set:
            break;
        case Tag::Kind::feature:
            if (!features_) startPart();
            features_ = true;
            next_.feature = tag.feature;
            if (tag.feature == Feature::unknown && !featureOfType(tag.text))
                warnings_.add(fmt::format("unknown feature name \"{}\"", tag.text.substr(0, 60)), line);
            break;
        case Tag::Kind::height:
            next_.height = static_cast<float>(intendedHeight(squeezed(tag.height)));
            break;
        case Tag::Kind::layer_change:
            markLayer(tag);
            break;
        case Tag::Kind::object_start:
            startObject(tag.text, line);
            break;
        case Tag::Kind::object_stop:
            if (!isSecondMark(tag.text)) stopObject();
            break;
        case Tag::Kind::color_change:
            changeColor(tag.tool < 0 ? next_.tool : static_cast<std::uint8_t>(tag.tool), parseColor(tag.text), line);
            break;
    }
}

void BeadRecorder::changeFilament(std::uint32_t line) {
    const auto& changes = toolpath_.color_changes;
    const bool named = !changes.empty() && changes.back().first_bead == toolpath_.beads.size();
    if (!named) changeColor(next_.tool, std::nullopt, line);
}

void BeadRecorder::changeColor(std::uint8_t tool, std::optional<Rgb> color, std::uint32_t line) {
    if (!color && toolpath_.empty()) return;  // the filament is changed before the print
    toolpath_.color_changes.push_back({.first_bead = static_cast<std::uint32_t>(toolpath_.beads.size()),
                                       .tool = tool,
                                       .color = color.value_or(Rgb{}),
                                       .stated = color.has_value()});
    if (color) return;
    warnings_.add("the filament is changed, and the file doesn't say to which colour; one of a palette stands for it",
                  line);
}

void BeadRecorder::heat(double tool, double temperature, std::uint32_t line) {
    constexpr double kHottest = 1000;
    if (!(tool >= 0 && tool < 255 && temperature > 0 && temperature <= kHottest)) return;  // 0: off
    toolpath_.temperatures.push_back(
        {.line = line, .tool = static_cast<std::uint8_t>(tool), .value = static_cast<float>(temperature)});
}

void BeadRecorder::blow(double speed, std::uint32_t line) {
    if (!(speed >= 0)) return;
    setFrom(toolpath_.fans, {.line = line, .tool = 0, .value = static_cast<float>(std::min(speed, 100.0))});
}

void BeadRecorder::accelerate(double acceleration, std::uint32_t line) {
    const Bounds bounds = boundsOf(Limit::printing);
    if (acceleration >= bounds.least && acceleration <= bounds.most)
        setFrom(toolpath_.accelerations, {.line = line, .tool = 0, .value = static_cast<float>(acceleration)});
}

void BeadRecorder::advance(double tool, double seconds, std::uint32_t line) {
    if (!(tool >= 0 && tool < 255 && seconds >= 0 && seconds <= kLongestAdvance)) return;
    setFrom(toolpath_.pressure_advances,
            {.line = line, .tool = static_cast<std::uint8_t>(tool), .value = static_cast<float>(seconds)});
}

void BeadRecorder::changeMix(ToolMix mix, std::uint32_t line) {
    const auto here = static_cast<std::uint32_t>(toolpath_.beads.size());
    // Machines set up many tools before they print, and gradients mix anew for every layer.
    const auto first = std::find_if(mixes_.rbegin(), mixes_.rend(), [here](const MixChange& one) {
                           return one.first_bead != here;
                       }).base();
    mixes_.erase(std::remove_if(first, mixes_.end(), [&](const MixChange& one) { return one.tool == mix.tool; }),
                 mixes_.end());
    mixes_.push_back({here, mix.tool, std::move(mix.shares), line});
}

void BeadRecorder::restartLayers() {
    for (Run& run : toolpath_.runs) run.layer = 0;
    next_.layer = 0;
    toolpath_.primed_mm = 0;
}

void BeadRecorder::startPart() {
    if (layer_marks_ || part_started_) return;
    part_started_ = true;
    if (toolpath_.beads.size() <= kMostPrimeBeads) restartLayers();
}

// Slicers write rounding errors (0.199999, 0.20001); layers of 0.15625 mm are intended.
double BeadRecorder::intendedHeight(double mm) {
    constexpr double kRounding = 3e-5;  // mm
    const double micrometres = std::round(mm * 1e3) / 1e3;
    return std::max(std::abs(mm - micrometres) < kRounding ? micrometres : std::round(mm * 1e5) / 1e5, 1e-3);
}

// Simplify3D lowers the nozzle on the first layer ("first layer height 80 %") and tags the height of the others. Much
// lower it makes up for a bed that lies deeper.
double BeadRecorder::squeezed(double height) const {
    const bool first = next_.layer == 1 && mark_ == "layer" && mark_z_;
    return first && *mark_z_ < height && *mark_z_ >= 0.5 * height ? *mark_z_ : height;
}

void BeadRecorder::markLayer(const Tag& mark) {
    if (!layer_marks_) {
        // The file has marks, so the beads counted by z so far came before the first layer.
        layer_marks_ = true;
        restartLayers();
    }
    // One layer, marked once by each process that prints in it, or once by the slicer and once by who asked for it.
    const bool same_z = mark.z && mark_z_ && std::abs(*mark.z - *mark_z_) < kSameZ;
    const bool empty = !mark_.empty() && toolpath_.beads.size() == beads_before_mark_;
    // Before the first layer's beads also the first kind again, whose first mark was in the start program.
    const bool again = empty && (mark.text != mark_ || (marked_twice_ && next_.layer == 1));
    marked_twice_ = again;
    if (mark.height > 0) tag({.kind = Tag::Kind::height, .height = mark.height}, 0);
    if (again) return;
    if (!same_z) ++next_.layer;
    // The next bead's z tells.
    repeats_ = marks_repeat_ && mark.text == "LAYER:" && toolpath_.beads.size() > beads_before_mark_ && next_.layer > 1;
    if (mark.raft || on_raft_ > 0) markOnRaft(mark.raft);
    mark_ = mark.text;
    mark_z_ = mark.z;
    beads_before_mark_ = toolpath_.beads.size();
}

// Cura lifts a part's first layer by an air gap, and presses the others down into it: of these two the distance to what
// lies below is no height.
void BeadRecorder::markOnRaft(bool raft) {
    constexpr int kLayers = 2;
    if (raft) {
        on_raft_ = kLayers + 1;
        return;
    }
    --on_raft_;
    if (nominal_height_ > 0) next_.height = on_raft_ > 0 ? static_cast<float>(nominal_height_) : 0.0F;
}

void BeadRecorder::countPlainMarks() {
    // Layers that are not level: z counts many more.
    constexpr std::size_t kFewest = 3;
    constexpr std::size_t kMore = 2;
    if (layer_marks_ || plain_marks_.size() < kFewest) return;
    std::erase_if(plain_marks_, [this](std::size_t mark) { return mark >= toolpath_.beads.size(); });
    plain_marks_.erase(std::unique(plain_marks_.begin(), plain_marks_.end()), plain_marks_.end());
    std::uint32_t layers = 0;
    for (const Run& run : toolpath_.runs) layers = std::max(layers, run.layer);
    if (plain_marks_.size() < kFewest || layers <= kMore * plain_marks_.size()) return;
    std::uint32_t run = 0;
    for (std::size_t bead = 0, layer = 0; bead < toolpath_.beads.size(); ++bead) {
        while (layer < plain_marks_.size() && plain_marks_[layer] <= bead) ++layer;
        for (; run <= toolpath_.beads[bead].run; ++run) toolpath_.runs[run].layer = static_cast<std::uint32_t>(layer);
    }
}

void BeadRecorder::finish() {
    auto& runs = toolpath_.runs;
    if (!layer_marks_ || std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.layer > 1; })) return;
    // One mark above a print that rises all the same, by somebody who cut the others out.
    constexpr std::size_t kRisen = 3;  // levels
    const bool marked = std::any_of(runs.begin(), runs.end(), [](const Run& run) { return run.layer > 0; });
    if (marked && levels(kRisen) < kRisen) return;
    layer_marks_ = false;
    next_.layer = 0;
    // A run of a known height goes on from level to level: each layer needs its own.
    const std::vector<Run> before = std::exchange(runs, {});
    run_z_.clear();
    std::optional<std::uint32_t> last;
    for (Bead& bead : toolpath_.beads) {
        const Point from{bead.x0, bead.y0, bead.z0};
        const Point to{bead.x1, bead.y1, bead.z1};
        const bool before_mark = marked && before[bead.run].layer == 0;
        const bool sloped = std::abs(to.z - from.z) > kSameZ;
        if (!before_mark) countLayer(from, to, sloped);
        if (last != bead.run || runs.back().layer != next_.layer) {
            last = bead.run;
            runs.push_back(before[bead.run]);
            runs.back().layer = next_.layer;
            run_z_.push_back(sloped ? std::numeric_limits<double>::quiet_NaN() : to.z);
        }
        bead.run = static_cast<std::uint32_t>(runs.size() - 1);
    }
}

std::size_t BeadRecorder::levels(std::size_t most) const {
    std::size_t count = 0;
    double highest = -std::numeric_limits<double>::infinity();
    for (const Bead& bead : toolpath_.beads) {
        if (count == most) break;
        if (bead.z0 != bead.z1 || !(bead.z1 > highest + kSameLevel)) continue;
        highest = bead.z1;
        ++count;
    }
    return count;
}

bool BeadRecorder::isSecondMark(std::string_view name) const {
    return name.starts_with(kObjectNumber) && next_.object != 0 &&
           !toolpath_.objects[next_.object].starts_with(kObjectNumber);
}

void BeadRecorder::startObject(std::string_view name, std::uint32_t line) {
    constexpr std::size_t kMaxObjects = std::numeric_limits<std::uint16_t>::max();
    if (isSecondMark(name)) return;
    const auto [entry, added] = object_index_.try_emplace(std::string(name), std::uint16_t{0});
    if (added) {
        if (toolpath_.objects.size() > kMaxObjects) {
            object_index_.erase(entry);
            warnings_.add("more than 65535 objects; the rest is unlabelled", line);
            return stopObject();
        }
        entry->second = static_cast<std::uint16_t>(toolpath_.objects.size());
        toolpath_.objects.emplace_back(name);
    }
    next_.object = entry->second;
}

void BeadRecorder::renameObject(std::string_view name, std::uint32_t line) {
    if (next_.object == 0 || object_index_.contains(std::string(name))) return startObject(name, line);
    object_index_.erase(toolpath_.objects[next_.object]);
    object_index_.emplace(name, next_.object);
    toolpath_.objects[next_.object] = name;
}

void BeadRecorder::countLayer(const Point& from, const Point& to, bool sloped) {
    const double z = std::max(from.z, to.z);
    if (next_.layer == 0) {
        next_.layer = 1;
        first_z_ = layer_z_ = z;
        return;
    }
    const bool rises = z > layer_z_ + (sloped ? 0.999 * nominal_height_ : kSameLevel);
    const bool starts_over = z < layer_z_ - kSameLevel && z < first_z_ + kSameLevel;
    if (!rises && !starts_over) return;
    ++next_.layer;
    layer_z_ = z;
}

void BeadRecorder::add(const Point& from, const Point& to, const std::optional<Arc>& arc, double length, double volume,
                       std::uint32_t line) {
    if (length > kLong && volume < kFinestSection * length)
        return warnings_.add(
            "lines of more than a metre that are thinner than 0.02 mm are left out; is a number damaged?", line);
    const bool sloped = std::abs(to.z - from.z) > kSameZ;
    if (!layer_marks_) countLayer(from, to, sloped);
    if (std::exchange(repeats_, false)) {
        const Bead& last = toolpath_.beads.back();
        if (!sloped && to.z == last.z1 && last.z0 == last.z1) --next_.layer;
    }
    // If the height is unknown, a run has one level, because the height will follow from the level.
    const double run_z = sloped ? std::numeric_limits<double>::quiet_NaN() : to.z;
    const bool same_level =
        !run_z_.empty() && (next_.height > 0 || (sloped ? std::isnan(run_z_.back()) : run_z_.back() == run_z));
    if (toolpath_.runs.empty() || !same_level || !(toolpath_.runs.back() == next_)) {
        toolpath_.runs.push_back(next_);
        run_z_.push_back(run_z);
    }
    Bead bead{.x0 = from.x, .y0 = from.y, .z0 = from.z, .x1 = to.x, .y1 = to.y, .z1 = to.z};
    bead.width = static_cast<float>(volume / length);
    bead.run = static_cast<std::uint32_t>(toolpath_.runs.size() - 1);
    if (arc) {
        // Reserves everything at once: growing would need the memory twice, and untouched pages cost nothing.
        if (toolpath_.arcs.empty()) toolpath_.arcs.reserve(toolpath_.beads.capacity() / 2);
        bead.arc = static_cast<std::int32_t>(toolpath_.arcs.size());
        toolpath_.arcs.push_back(*arc);
        toolpath_.arcs.back().line = line;
    } else {
        bead.arc = -static_cast<std::int32_t>(std::min<std::uint32_t>(line, std::numeric_limits<std::int32_t>::max()));
    }
    toolpath_.beads.push_back(bead);
}

}  // namespace stratum::gcode
