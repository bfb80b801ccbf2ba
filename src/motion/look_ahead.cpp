#include "motion/look_ahead.h"

#include "motion/exact_look_ahead.h"
#include "motion/klipper_look_ahead.h"
#include "motion/marlin_look_ahead.h"

namespace stratum::motion {
namespace {

enum class Kind { exact, klipper, marlin };

Kind kindOf(gcode::CornerRule rule) {
    switch (rule) {
        case gcode::CornerRule::corner_velocity:
            return Kind::klipper;
        case gcode::CornerRule::junction_deviation:
        case gcode::CornerRule::marlin_jerk:
            return Kind::marlin;
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
        default:
            return std::make_unique<ExactLookAhead>(sink);
    }
}

bool looksAheadAlike(gcode::CornerRule a, gcode::CornerRule b) { return kindOf(a) == kindOf(b); }

}  // namespace stratum::motion
