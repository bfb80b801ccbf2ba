#include "motion/look_ahead.h"

#include "motion/exact_look_ahead.h"
#include "motion/klipper_look_ahead.h"
#include "motion/marlin_look_ahead.h"

namespace stratum::motion {
namespace {

enum class Kind { exact, klipper, marlin, none };

// Each segment at its programmed speed, as if nothing had a mass.
class NoLookAhead : public LookAhead {
public:
    explicit NoLookAhead(SettledSink& sink) : sink_(sink) {}

    void add(const Segment& segment, const gcode::MachineLimits&) override {
        const double v = segment.asked;
        sink_.settled(segment, {.entry = v, .peak = v, .exit = v, .acceleration = 1, .cruising = segment.length / v});
    }
    void stop() override {}

private:
    SettledSink& sink_;
};

Kind kindOf(gcode::CornerRule rule) {
    switch (rule) {
        case gcode::CornerRule::corner_velocity:
            return Kind::klipper;
        case gcode::CornerRule::junction_deviation:
        case gcode::CornerRule::marlin_jerk:
            return Kind::marlin;
        case gcode::CornerRule::programmed:
            return Kind::none;
        default:
            return Kind::exact;
    }
}

}  // namespace

std::unique_ptr<LookAhead> makeLookAhead(gcode::CornerRule rule, SettledSink& sink) {
    switch (kindOf(rule)) {
        case Kind::klipper:
            return std::make_unique<KlipperLookAhead>(sink);
        case Kind::marlin:
            return std::make_unique<MarlinLookAhead>(sink);
        case Kind::none:
            return std::make_unique<NoLookAhead>(sink);
        default:
            return std::make_unique<ExactLookAhead>(sink);
    }
}

bool looksAheadAlike(gcode::CornerRule a, gcode::CornerRule b) { return kindOf(a) == kindOf(b); }

}  // namespace stratum::motion
