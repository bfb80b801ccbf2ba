// The nozzle's position in print space, and the offsets between print space and the program's coordinates, for x, y, z.
//
// Print space is the coordinate frame in force when the first bead is laid. Before that, a command that changes the
// coordinates of the current position (G92, a workspace, a home offset) changes them in print space as well; afterwards
// it moves the program's frame inside print space, so that a program can print the same lines again elsewhere.
// Sources: marlinfw.org/docs/gcode G053-G059, G092, M206 (a G92 belongs to the workspace in which it was given; G53
// goes back to the native one); docs.duet3d.com G10 L2/L20 and G92; klipper3d.org/G-Codes.html SET_GCODE_OFFSET.
#pragma once

#include <array>
#include <cstddef>

namespace stratum::gcode {

/// A position of the nozzle in print space, mm.
struct Point {
    double x = 0;
    double y = 0;
    double z = 0;
    double& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
    double operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

/// All lengths in mm; axis 0, 1, 2 is x, y, z. Workspace 0 is the machine's own, 1..9 are G54..G59.3.
class Frame {
public:
    static constexpr std::size_t kWorkspaces = 10;

    explicit Frame(std::size_t workspace) : active_(workspace) {}

    const Point& position() const { return position_; }
    void moveTo(const Point& target) { position_ = target; }
    /// Print space minus the program's coordinates.
    const Point& offset() const { return offset_; }
    double program(std::size_t axis) const { return position_[axis] - offset_[axis]; }

    /// Fixes print space; to be called before the first bead is laid.
    void freezePrintSpace() { frozen_ = true; }

    /// G28: the axis is at its endstop. Resets its workspace offset; the position becomes that of the endstop.
    void home(std::size_t axis);
    /// G92: the current position gets the coordinate `value`.
    void setG92Position(std::size_t axis, double value);
    /// G92.1 clears the offsets of this workspace, G92.2 suspends them, G92.3 resumes suspended ones.
    void clearG92Offsets();
    void suspendG92Offsets();
    void resumeG92Offsets();
    /// G53..G59.3.
    void select(std::size_t workspace);
    std::size_t workspace() const { return active_; }
    /// G10 L2: the machine's coordinate of the workspace's origin.
    void setWorkspaceOrigin(std::size_t workspace, std::size_t axis, double origin);
    /// G10 L20: the current position gets the coordinate `value` in that workspace.
    void setWorkspacePosition(std::size_t workspace, std::size_t axis, double value);
    /// Program minus machine coordinate, in all workspaces (M206; the negative of Klipper's SET_GCODE_OFFSET).
    void setHomeOffset(std::size_t axis, double offset);
    double homeOffset(std::size_t axis) const { return home_offset_[axis]; }
    /// Offset of the current tool's nozzle from the program's coordinates (for slicers that subtract it from them).
    void setToolOffset(const Point& offset);

    /// The bed sinks by that much (mm) below the nozzle: both the nozzle and the program's frame rise above the print.
    void lowerBed(double by);

    /// Restores the offsets of `earlier` (SAVE_GCODE_STATE, RESTORE_GCODE_STATE); the nozzle doesn't move.
    void restoreOffsets(const Frame& earlier);

private:
    double native(std::size_t axis) const {
        return program(axis) - home_offset_[axis] - workspace_offset_[active_][axis];
    }
    /// Adds `by` to the program's coordinate of the current position.
    void addOffset(std::size_t axis, double by);

    Point position_;
    Point offset_;
    Point tool_offset_;
    Point home_offset_;
    std::array<Point, kWorkspaces> workspace_offset_{};  // program minus machine coordinate, without home_offset_
    Point suspended_;
    std::size_t active_;
    bool frozen_ = false;
};

}  // namespace stratum::gcode
