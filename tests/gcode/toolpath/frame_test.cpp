#include "gcode/toolpath/frame.h"

#include <gtest/gtest.h>

namespace stratum::gcode {
namespace {

TEST(Frame, BeforeTheFirstBeadNamesMovePrintSpace) {
    Frame frame(0);
    frame.moveTo({5, 0, 10});
    frame.rename(2, 0.2);
    EXPECT_EQ(frame.position().z, 0.2);
    EXPECT_EQ(frame.offset().z, 0);
    frame.dropNames();
    EXPECT_NEAR(frame.position().z, 10, 1e-12);
}

TEST(Frame, AfterwardsTheyMoveTheProgram) {
    Frame frame(0);
    frame.settle();
    frame.moveTo({30, 0, 0});
    frame.rename(0, 0);
    EXPECT_EQ(frame.position().x, 30);
    EXPECT_EQ(frame.offset().x, 30);
    EXPECT_EQ(frame.program(0), 0);
    frame.suspendNames();
    EXPECT_EQ(frame.program(0), 30);
    frame.resumeNames();
    EXPECT_EQ(frame.program(0), 0);
}

TEST(Frame, HomingTakesPrintSpaceAlong) {
    Frame frame(0);
    frame.moveTo({7, 8, 0});
    frame.settle();
    frame.rename(0, 0);
    frame.home(0);
    EXPECT_EQ(frame.position().x, 0);
    EXPECT_EQ(frame.offset().x, 0);
    EXPECT_EQ(frame.position().y, 8);
}

TEST(Frame, WorkspacesRememberTheirNames) {
    Frame frame(1);
    frame.settle();
    frame.moveTo({10, 0, 0});
    frame.select(2);
    frame.rename(0, 0);
    frame.select(1);
    EXPECT_EQ(frame.program(0), 10);
    frame.select(2);
    EXPECT_EQ(frame.program(0), 0);
    frame.setOrigin(3, 0, 4);
    frame.select(3);
    EXPECT_EQ(frame.program(0), 6);
    frame.setPlace(1, 0, -1);
    frame.select(1);
    EXPECT_EQ(frame.program(0), -1);
    EXPECT_EQ(frame.position().x, 10);  // through all of it the nozzle stays
}

TEST(Frame, TheMachinesOwnWorkspaceForgets) {
    Frame frame(0);
    frame.settle();
    frame.rename(0, 5);
    frame.select(1);
    frame.select(0);
    EXPECT_EQ(frame.program(0), 0);
}

TEST(Frame, ShiftsHoldInAllWorkspacesAndThroughHoming) {
    Frame frame(0);
    frame.settle();
    frame.setShift(2, -0.1);
    EXPECT_DOUBLE_EQ(frame.program(2), -0.1);
    frame.select(4);
    EXPECT_DOUBLE_EQ(frame.program(2), -0.1);
    frame.home(2);
    EXPECT_DOUBLE_EQ(frame.program(2), -0.1);
}

TEST(Frame, ToolOffsetsMoveTheNozzleNotTheProgram) {
    Frame frame(0);
    frame.moveTo({10, 0, 0});
    frame.setToolOffset({18, 0, 0});
    EXPECT_EQ(frame.program(0), 10);
    EXPECT_EQ(frame.position().x, 28);
    frame.rename(0, 1);
    EXPECT_EQ(frame.program(0), 1);
    frame.home(0);
    EXPECT_EQ(frame.position().x, 18);
}

}  // namespace
}  // namespace stratum::gcode
