#include "gcode/toolpath/frame.h"

namespace stratum::gcode {

void Frame::addOffset(std::size_t axis, double by) {
    if (frozen_)
        offset_[axis] -= by;
    else
        position_[axis] += by;
}

void Frame::home(std::size_t axis) {
    workspace_offset_[active_][axis] = 0;
    offset_[axis] = tool_offset_[axis];
    position_[axis] = home_offset_[axis] + offset_[axis];
}

void Frame::setG92Position(std::size_t axis, double value) {
    workspace_offset_[active_][axis] += value - program(axis);
    // Set instead of added, so that the program's coordinate has exactly this value.
    if (frozen_)
        offset_[axis] = position_[axis] - value;
    else
        position_[axis] = value + offset_[axis];
}

void Frame::clearG92Offsets() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        addOffset(axis, -workspace_offset_[active_][axis]);
        workspace_offset_[active_][axis] = 0;
    }
    suspended_ = {};
}

void Frame::suspendG92Offsets() {
    const Point offset = workspace_offset_[active_];
    clearG92Offsets();
    suspended_ = offset;
}

void Frame::resumeG92Offsets() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        addOffset(axis, suspended_[axis]);
        workspace_offset_[active_][axis] += suspended_[axis];
    }
    suspended_ = {};
}

void Frame::select(std::size_t workspace) {
    if (workspace == active_) return;
    if (workspace == 0) workspace_offset_[0] = {};
    for (std::size_t axis = 0; axis < 3; ++axis)
        addOffset(axis, workspace_offset_[workspace][axis] - workspace_offset_[active_][axis]);
    active_ = workspace;
}

void Frame::setWorkspaceOrigin(std::size_t workspace, std::size_t axis, double origin) {
    if (workspace == active_) addOffset(axis, -origin - workspace_offset_[workspace][axis]);
    workspace_offset_[workspace][axis] = -origin;
}

void Frame::setWorkspacePosition(std::size_t workspace, std::size_t axis, double value) {
    if (workspace == active_) return setG92Position(axis, value);
    workspace_offset_[workspace][axis] = value - home_offset_[axis] - native(axis);
}

void Frame::setHomeOffset(std::size_t axis, double offset) {
    addOffset(axis, offset - home_offset_[axis]);
    home_offset_[axis] = offset;
}

void Frame::restoreOffsets(const Frame& earlier) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double offset = earlier.workspace_offset_[earlier.active_][axis];
        addOffset(axis, offset + earlier.home_offset_[axis] - workspace_offset_[active_][axis] - home_offset_[axis]);
        workspace_offset_[active_][axis] = offset;
    }
    home_offset_ = earlier.home_offset_;
}

void Frame::lowerBed(double by) {
    position_.z += by;
    offset_.z += by;
}

void Frame::setToolOffset(const Point& offset) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        position_[axis] += offset[axis] - tool_offset_[axis];
        offset_[axis] += offset[axis] - tool_offset_[axis];
    }
    tool_offset_ = offset;
}

}  // namespace stratum::gcode
