#include "motion/clock_fit.h"

#include "motion/planner.h"

#include <algorithm>
#include <cmath>

namespace stratum::motion {
namespace {

using gcode::Limit;
using gcode::MachineLimits;

constexpr std::size_t kFewestLayers = 8;   // to fit two numbers and see whether they hold for others, too
constexpr std::size_t kEnoughLayers = 24;  // layers and moves are kept until there are enough of both
constexpr std::size_t kEnoughMoves = 10000;
constexpr std::size_t kMostMoves = 200000;  // 22 MB
constexpr double kShortestLayer = 1;        // s; the clock has six digits, but below that anything disturbs
constexpr double kClose = 0.002;            // of a layer's time
constexpr double kLeastAcceleration = 50;   // mm/s^2
constexpr double kMostAcceleration = 30000;
constexpr double kLeastJerk = 1;  // mm/s
constexpr double kMostJerk = 60;

class NoPlan : public PlanSink {
public:
    void piece(const PlannedPiece&) override {}
    void wait(double, double) override {}
};

void set(const FittedLimits& fitted, MachineLimits& limits) {
    limits.printing = limits.travel = limits.retracting = fitted.acceleration;
    limits.jerk[0] = limits.jerk[1] = fitted.jerk;
}

// Where in [low, high], by golden section, a function with one valley is least.
template <typename Function>
double leastOf(double low, double high, int steps, const Function& function) {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    double a = high - golden * (high - low);
    double b = low + golden * (high - low);
    double at_a = function(a);
    double at_b = function(b);
    for (int step = 0; step < steps; ++step) {
        if (at_a <= at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - golden * (high - low);
            at_a = function(a);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + golden * (high - low);
            at_b = function(b);
        }
    }
    return (low + high) / 2;
}

}  // namespace

void ClockFit::limits(const MachineLimits& limits) {
    if (!begun_) {
        begun_ = true;
        guess_ = limits;
        keeping_ = limits.guessed && limits.rule == gcode::CornerRule::plan_jerk;
    }
    const bool same = limits.printing == guess_.printing && limits.travel == guess_.travel &&
                      limits.retracting == guess_.retracting && limits.jerk == guess_.jerk &&
                      limits.acceleration == guess_.acceleration && limits.rule == guess_.rule;
    if (keeping_ && !same) {
        // The program states them.
        layers_.clear();
        finish();
    }
    if (!keeping_) return planner_.limits(corrected(limits));
    events_.emplace_back(Change{changes_.size()});
    changes_.push_back(limits);
}

void ClockFit::move(const gcode::Move& move) {
    keep(move);
    if (keeping_ && events_.size() >= kMostMoves) finish();
}

void ClockFit::wait(double seconds) { keep(Wait{seconds}); }
void ClockFit::stop(gcode::Stop kind, std::uint32_t line) { keep(Halt{kind, line}); }

void ClockFit::elapsed(double seconds) {
    planner_.elapsed(seconds);
    if (!keeping_) return;
    // What comes before the first mark has the user's start program in it, whose time the slicer doesn't count.
    if (clock_ && seconds - *clock_ >= kShortestLayer) layers_.push_back({marked_, events_.size(), seconds - *clock_});
    clock_ = seconds;
    marked_ = events_.size();
    if (layers_.size() >= kEnoughLayers && events_.size() >= kEnoughMoves) finish();
}

void ClockFit::origin(const gcode::LimitOrigins& origins) {
    finish();  // nothing but the origins comes behind them
    if (!fitted_) return planner_.origin(origins);
    gcode::LimitOrigins told = origins;
    const auto fit = [&](Limit limit, double value) {
        told[limit].kind = gcode::LimitOrigin::Kind::fitted;
        told[limit].value = value;
    };
    for (const Limit limit : {Limit::printing, Limit::travel, Limit::retracting}) fit(limit, fitted_->acceleration);
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
        fit(gcode::ofAxis(Limit::jerk, axis), fitted_->jerk);
    planner_.origin(told);
}

void ClockFit::finish() {
    if (!keeping_) return;
    fit();
    keeping_ = false;
    for (const Event& event : events_) pass(event);
    events_ = {};
    changes_ = {};
    layers_ = {};
}

void ClockFit::keep(const Event& event) {
    if (keeping_)
        events_.push_back(event);
    else
        pass(event);
}

void ClockFit::pass(const Event& event) {
    if (const auto* move = std::get_if<gcode::Move>(&event)) return planner_.move(*move);
    if (const auto* wait = std::get_if<Wait>(&event)) return planner_.wait(wait->seconds);
    if (const auto* halt = std::get_if<Halt>(&event)) return planner_.stop(halt->kind, halt->line);
    if (const auto* change = std::get_if<Change>(&event)) planner_.limits(corrected(changes_[change->limits]));
}

// A later command of the program holds.
MachineLimits ClockFit::corrected(MachineLimits limits) const {
    if (!fitted_) return limits;
    for (double MachineLimits::*one : {&MachineLimits::printing, &MachineLimits::travel, &MachineLimits::retracting})
        if (limits.*one == guess_.*one) limits.*one = fitted_->acceleration;
    for (const std::size_t axis : {std::size_t{0}, std::size_t{1}})
        if (limits.jerk[axis] == guess_.jerk[axis]) limits.jerk[axis] = fitted_->jerk;
    return limits;
}

double ClockFit::plannedSeconds(const Layer& layer, const FittedLimits& limits) const {
    NoPlan nothing;
    Planner planner(nothing);
    MachineLimits tried = guess_;
    set(limits, tried);
    planner.limits(tried);
    for (std::size_t n = layer.begin; n < layer.end; ++n) {
        if (const auto* move = std::get_if<gcode::Move>(&events_[n])) planner.move(*move);
        if (const auto* wait = std::get_if<Wait>(&events_[n])) planner.wait(wait->seconds);
    }
    planner.finish();
    return planner.seconds();
}

// A sum of sizes, not of squares: some layers have times of other causes.
double ClockFit::misfit(const FittedLimits& limits) const {
    double sum = 0;
    for (const Layer& layer : layers_) sum += std::abs(plannedSeconds(layer, limits) / layer.seconds - 1);
    return sum;
}

double ClockFit::medianError(const FittedLimits& limits) const {
    std::vector<double> errors;
    errors.reserve(layers_.size());
    for (const Layer& layer : layers_) errors.push_back(std::abs(plannedSeconds(layer, limits) / layer.seconds - 1));
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
}

void ClockFit::fit() {
    if (layers_.size() < kFewestLayers || medianError({guess_.printing, guess_.jerk[0]}) <= kClose) return;
    // 14 and 12 steps: to a tenth of a per cent of the ranges' logarithms.
    const auto accelerationBy = [this](double log_jerk) {
        const double jerk = std::exp(log_jerk);
        return std::exp(leastOf(std::log(kLeastAcceleration), std::log(kMostAcceleration), 14, [&](double log) {
            return misfit({std::exp(log), jerk});
        }));
    };
    const double log_jerk = leastOf(std::log(kLeastJerk), std::log(kMostJerk), 12, [&](double log) {
        return misfit({accelerationBy(log), std::exp(log)});
    });
    const FittedLimits found{accelerationBy(log_jerk), std::exp(log_jerk)};
    if (medianError(found) <= kClose) fitted_ = found;
}

}  // namespace stratum::motion
