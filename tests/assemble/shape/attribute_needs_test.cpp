#include "assemble/shape/attribute_needs.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stratum::assemble {
namespace {

ObjectOptions objectOf(const std::string& vdb, const std::string& grid = "") { return {.vdb = vdb, .grid = grid}; }

TEST(AttributeNeeds, NumbersNamesInTheirOrder) {
    AttributeNeeds needs;
    EXPECT_EQ(needs.number("layer"), 0U);
    EXPECT_EQ(needs.number("tool"), 1U);
    EXPECT_EQ(needs.number("layer"), 0U);
    EXPECT_EQ(needs.names(), (std::vector<std::string>{"layer", "tool"}));
}

TEST(AttributeNeeds, ObjectsOfOneFileAndGridShareThem) {
    AttributeNeeds needs;
    needs.add(objectOf("a.vdb"), "tool");
    needs.addStatedColors(objectOf("b.gcode"));
    EXPECT_TRUE(needs.contains(objectOf("a.vdb"), "tool"));
    EXPECT_FALSE(needs.contains(objectOf("a.vdb"), "layer"));
    EXPECT_FALSE(needs.contains(objectOf("a.vdb", "other"), "tool"));
    EXPECT_FALSE(needs.needsStatedColors(objectOf("a.vdb")));
    EXPECT_TRUE(needs.needsStatedColors(objectOf("b.gcode")));
}

}  // namespace
}  // namespace stratum::assemble
