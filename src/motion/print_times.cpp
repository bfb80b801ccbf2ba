#include "motion/print_times.h"

#include "gcode/option_names.h"
#include "gcode/slicer/settings.h"
#include "gcode/summary.h"
#include "motion/clock_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace stratum::motion {
namespace {

using gcode::CornerRule;

// Collects the data for the sums while the toolpath is being read.
class Recorder : public PlanSink {
public:
    Recorder(PlanSink* also, std::vector<Travel>* travels) : also_(also), travels_(travels) {}

    void piece(const PlannedPiece& piece) override {
        if (also_ != nullptr) also_->piece(piece);
        const Segment& segment = piece.segment;
        const double seconds = piece.speed.seconds();
        if (segment.bead == gcode::Move::kNoBead) {
            (segment.travels ? travel : retraction) += seconds;
            if (travels_ != nullptr && segment.travel != gcode::Move::kNoBead) {
                Travel& of = (*travels_)[segment.travel];
                if (of.seconds == 0) of.start = piece.start;
                of.seconds += static_cast<float>(seconds);
            }
            return;
        }
        if (timing.size() <= segment.bead) {
            extend(segment.bead, piece.start);
            timing.push_back({.start = piece.start});
            timing.back().entry = static_cast<float>(piece.speed.entry);
        }
        gcode::BeadTiming& bead = timing[segment.bead];
        bead.seconds += static_cast<float>(seconds);
        bead.peak = std::max(bead.peak, static_cast<float>(piece.speed.peak));
        bead.exit = static_cast<float>(piece.speed.exit);
    }
    void wait(double start, double seconds) override {
        if (also_ != nullptr) also_->wait(start, seconds);
        waiting += seconds;
    }

    /// Beads without motion are laid when the one before them is: a second carriage's copies (M605).
    void extend(std::size_t beads, double start) {
        gcode::BeadTiming timed{.start = start};
        if (!timing.empty()) {
            timed = timing.back();
            timed.start += static_cast<double>(timed.seconds);
            timed.seconds = 0;
        }
        timing.resize(beads, timed);
    }

    std::vector<gcode::BeadTiming> timing;
    double travel = 0;
    double retraction = 0;
    double waiting = 0;

private:
    PlanSink* also_;
    std::vector<Travel>* travels_;
};

class TimedPlanner : public Planner {
public:
    using Planner::Planner;
    void origin(const gcode::LimitOrigins& origins) override { limits = origins; }

    gcode::LimitOrigins limits;
};

void addUp(const gcode::Toolpath& toolpath, PrintTimes& times) {
    times.layers = gcode::layerSeconds(toolpath);
    std::size_t layer = 0;
    double end = 0;
    for (std::size_t i = 0; i < toolpath.timing.size(); ++i) {
        const gcode::BeadTiming& timing = toolpath.timing[i];
        const gcode::Run& run = toolpath.runOf(toolpath.beads[i]);
        const double seconds = static_cast<double>(timing.seconds);
        times.features[static_cast<std::size_t>(run.feature)] += seconds;
        if (layer == 0 && run.layer > 0) times.before_model = timing.start;
        layer = run.layer;
        if (i == 0) times.layers[layer] += timing.start;
        end = timing.start + seconds;
    }
    times.after_model = times.total - end;
    times.layers[layer] += times.after_model;
}

// The rule that a slicer estimates by, and what it multiplies by; automatic: the one that was planned by.
struct Estimate {
    CornerRule rule = CornerRule::automatic;
    double factor = 1;
};

Estimate estimateOf(const PrintTimes& times, const gcode::Toolpath& toolpath) {
    if (toolpath.slicer.starts_with("Simplify3D")) return {CornerRule::programmed};
    if (toolpath.slicer.starts_with("Kiri:Moto")) return {CornerRule::programmed, 1.5};
    const bool states_jerk = times.limits[ofAxis(gcode::Limit::jerk, 0)].kind == gcode::LimitOrigin::Kind::setting;
    if (times.limits.rule != CornerRule::corner_velocity || !states_jerk) return {};
    if (toolpath.stated.programs_left_out) return {CornerRule::plan_jerk};
    return {gcode::estimatesByVelocity(toolpath.slicer) ? CornerRule::bambu_jerk : CornerRule::slicer_jerk};
}

}  // namespace

std::string_view ruleName(CornerRule rule) { return gcode::kCornerRules[static_cast<std::size_t>(rule)].first; }

std::optional<PrintTimes> estimatedTimes(std::string_view bytes, std::string_view name,
                                         const gcode::ReadOptions& options, const PrintTimes& times,
                                         const gcode::Toolpath& toolpath) {
    const gcode::StatedFacts& facts = toolpath.stated;
    if (options.corner_rule != CornerRule::automatic || options.printer || !facts.seconds) return std::nullopt;
    const auto [rule, factor] = estimateOf(times, toolpath);
    if (rule == CornerRule::automatic) return std::nullopt;
    gcode::ReadOptions read = options;
    read.corner_rule = rule;
    read.progress = {};
    PrintTimes estimate;
    readTimedToolpath(bytes, name, read, estimate);
    if (factor == 1) return estimate;
    for (double* seconds : {&estimate.total, &estimate.travel, &estimate.retraction, &estimate.waiting,
                            &estimate.before_model, &estimate.after_model})
        *seconds *= factor;
    for (double& seconds : estimate.features) seconds *= factor;
    for (double& seconds : estimate.layers) seconds *= factor;
    estimate.rule += fmt::format(" times {}", factor);
    return estimate;
}

StatedTime statedTime(const PrintTimes& times, const gcode::StatedFacts& facts) {
    if (facts.model_seconds) return {*facts.model_seconds, times.total - times.before_model};
    const double programs = facts.programs_left_out ? times.before_model + times.after_model : 0;
    return {facts.seconds.value_or(0), times.total - programs};
}

gcode::Toolpath readTimedToolpath(std::string_view bytes, std::string_view name, const gcode::ReadOptions& options,
                                  PrintTimes& times, PlanSink* also, std::vector<Travel>* travels) {
    Recorder recorder(also, travels);
    TimedPlanner planner(recorder);
    gcode::ReadOptions read = options;
    ClockFit fit(planner);
    std::optional<TravelRecorder> moves;
    read.motion = &fit;
    if (travels != nullptr) read.motion = &moves.emplace(*travels, &fit);
    gcode::Toolpath toolpath = gcode::readToolpath(bytes, name, read);
    fit.finish();
    planner.finish();
    recorder.extend(toolpath.beads.size(), planner.seconds());
    toolpath.timing = std::move(recorder.timing);
    times.total = planner.seconds();
    times.travel = recorder.travel;
    times.retraction = recorder.retraction;
    times.waiting = recorder.waiting;
    times.rule = ruleName(planner.rule());
    times.limits = planner.limits;
    addUp(toolpath, times);
    return toolpath;
}

}  // namespace stratum::motion
