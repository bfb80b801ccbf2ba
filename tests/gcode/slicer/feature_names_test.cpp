#include "gcode/slicer/feature_names.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(FeatureNames, HaveNoCase) {
    EXPECT_EQ(featureOfType("IRONING"), Feature::ironing);
    EXPECT_EQ(featureOfBareName("Gap Fill"), Feature::gap_fill);
    EXPECT_EQ(featureOfSegment("softsupport"), Feature::support_interface);
    EXPECT_EQ(featureOfPath("SOLID"), Feature::solid_infill);
}

TEST(FeatureNames, UnknownOnes) {
    for (const auto* name : {"", "wobble", "perimeterx", "skir"}) {
        EXPECT_FALSE(featureOfType(name)) << name;
        EXPECT_FALSE(featureOfBareName(name)) << name;
        EXPECT_FALSE(featureOfSegment(name)) << name;
        EXPECT_FALSE(featureOfPath(name)) << name;
    }
}

TEST(FeatureNames, RolesWithoutAPlaceOfTheirOwnAreKnown) {
    EXPECT_EQ(featureOfType("Mixed"), Feature::unknown);
    EXPECT_EQ(featureOfType("Undefined"), Feature::unknown);
}

}  // namespace
}  // namespace stratum::gcode
