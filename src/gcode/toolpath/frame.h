// Where the nozzle is, and how the program's coordinates lie in print space, for x, y and z.
//
// Print space is the coordinate frame in force when the first bead is laid. Before that, whatever renames the place
// (G92 when touching off, a workspace, a home offset) renames it for print space too; afterwards it moves the program's
// frame inside print space, so that a program that prints the same lines again elsewhere does.
// Sources: marlinfw.org/docs/gcode G053-G059, G092, M206 (a G92 belongs to the workspace in which it was given; G53
// goes back to the native one); docs.duet3d.com G10 L2/L20 and G92; klipper3d.org/G-Codes.html SET_GCODE_OFFSET.
#pragma once

#include <array>
#include <cstddef>

namespace stratum::gcode {

/// A place of the nozzle in print space, mm.
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

    /// The first bead is being laid: print space is what it is.
    void settle() { settled_ = true; }

    /// The axis is at its switch: the program's coordinates are the machine's again, and print space follows.
    void home(std::size_t axis);
    /// G92: the place is called `value` from now on.
    void rename(std::size_t axis, double value);
    /// G92.1 drops what G92 did in this workspace, G92.2 does so for a while, G92.3 takes it up again.
    void dropNames();
    void suspendNames();
    void resumeNames();
    /// G53..G59.3.
    void select(std::size_t workspace);
    std::size_t workspace() const { return active_; }
    /// G10 L2: the machine's coordinate of the workspace's origin.
    void setOrigin(std::size_t workspace, std::size_t axis, double origin);
    /// G10 L20: the nozzle's place is called `value` in that workspace.
    void setPlace(std::size_t workspace, std::size_t axis, double value);
    /// What the program adds to every coordinate of the machine, in all workspaces (M206; minus Klipper's offset).
    void setShift(std::size_t axis, double shift);
    double shift(std::size_t axis) const { return shift_[axis]; }
    /// How far the nozzle of the tool in use is from where the program's numbers say (a slicer that subtracts it).
    void setToolOffset(const Point& offset);

    /// Gives places the names that they had in `earlier` (SAVE_GCODE_STATE, RESTORE_GCODE_STATE); the nozzle stays.
    void takeNames(const Frame& earlier);

private:
    double native(std::size_t axis) const { return program(axis) - shift_[axis] - names_[active_][axis]; }
    void changed(std::size_t axis, double by);

    Point position_;
    Point offset_;
    Point tool_offset_;
    Point shift_;
    std::array<Point, kWorkspaces> names_{};  // program minus machine coordinate, without shift_
    Point suspended_;
    std::size_t active_;
    bool settled_ = false;
};

}  // namespace stratum::gcode
