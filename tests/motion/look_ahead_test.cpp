#include "motion/look_ahead.h"

#include "motion/exact_look_ahead.h"
#include "motion/klipper_look_ahead.h"
#include "motion/marlin_look_ahead.h"

#include <gtest/gtest.h>

namespace stratum::motion {
namespace {

using gcode::CornerRule;

class Nobody : public SettledSink {
public:
    void settled(const Segment&, const Trapezoid&) override {}
};

template <typename Kind>
bool is(CornerRule rule) {
    Nobody sink;
    return dynamic_cast<const Kind*>(makeLookAhead(rule, sink).get()) != nullptr;
}

TEST(LookAhead, EachFirmwareHasItsOwn) {
    EXPECT_TRUE(is<KlipperLookAhead>(CornerRule::corner_velocity));
    EXPECT_TRUE(is<MarlinLookAhead>(CornerRule::junction_deviation));
    EXPECT_TRUE(is<MarlinLookAhead>(CornerRule::marlin_jerk));
    for (const CornerRule rule :
         {CornerRule::jerk, CornerRule::slicer_jerk, CornerRule::plan_jerk, CornerRule::reprap_jerk})
        EXPECT_TRUE(is<ExactLookAhead>(rule));
    EXPECT_TRUE(looksAheadAlike(CornerRule::junction_deviation, CornerRule::marlin_jerk));
    EXPECT_FALSE(looksAheadAlike(CornerRule::junction_deviation, CornerRule::jerk));
}

}  // namespace
}  // namespace stratum::motion
