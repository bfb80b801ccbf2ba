#include "gcode/toolpath/frame.h"

namespace stratum::gcode {

void Frame::changed(std::size_t axis, double by) {
    if (settled_)
        offset_[axis] -= by;
    else
        position_[axis] += by;
}

void Frame::home(std::size_t axis) {
    names_[active_][axis] = 0;
    offset_[axis] = tool_offset_[axis];
    position_[axis] = shift_[axis] + offset_[axis];
}

void Frame::rename(std::size_t axis, double value) {
    names_[active_][axis] += value - program(axis);
    // Set, not added up: what the program says is to come out digit for digit.
    if (settled_)
        offset_[axis] = position_[axis] - value;
    else
        position_[axis] = value + offset_[axis];
}

void Frame::dropNames() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        changed(axis, -names_[active_][axis]);
        names_[active_][axis] = 0;
    }
    suspended_ = {};
}

void Frame::suspendNames() {
    const Point names = names_[active_];
    dropNames();
    suspended_ = names;
}

void Frame::resumeNames() {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        changed(axis, suspended_[axis]);
        names_[active_][axis] += suspended_[axis];
    }
    suspended_ = {};
}

void Frame::select(std::size_t workspace) {
    if (workspace == active_) return;
    if (workspace == 0) names_[0] = {};
    for (std::size_t axis = 0; axis < 3; ++axis) changed(axis, names_[workspace][axis] - names_[active_][axis]);
    active_ = workspace;
}

void Frame::setOrigin(std::size_t workspace, std::size_t axis, double origin) {
    if (workspace == active_) changed(axis, -origin - names_[workspace][axis]);
    names_[workspace][axis] = -origin;
}

void Frame::setPlace(std::size_t workspace, std::size_t axis, double value) {
    if (workspace == active_) return rename(axis, value);
    names_[workspace][axis] = value - shift_[axis] - native(axis);
}

void Frame::setShift(std::size_t axis, double shift) {
    changed(axis, shift - shift_[axis]);
    shift_[axis] = shift;
}

void Frame::takeNames(const Frame& earlier) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double names = earlier.names_[earlier.active_][axis];
        changed(axis, names + earlier.shift_[axis] - names_[active_][axis] - shift_[axis]);
        names_[active_][axis] = names;
    }
    shift_ = earlier.shift_;
}

void Frame::setToolOffset(const Point& offset) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        position_[axis] += offset[axis] - tool_offset_[axis];
        offset_[axis] += offset[axis] - tool_offset_[axis];
    }
    tool_offset_ = offset;
}

}  // namespace stratum::gcode
