// The machine simulator: commands -> positions, extrusion, beads.
//
// Lengths are mm, E is mm of filament or mm^3, feed rates mm/s. Where nothing has been said the machine stands at 0.
// Sources: marlinfw.org/docs/gcode (G0-G3, G10, G20, G28, G90, G92, M82, M200, M221); docs.duet3d.com and
// klipper3d.org/G-Codes.html (G90/G91 leave E alone there).
#pragma once

#include "gcode/arc.h"
#include "gcode/bead_recorder.h"
#include "gcode/lexer.h"
#include "gcode/reader.h"
#include "gcode/settings.h"
#include "gcode/warning_log.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// What the machine did, for messages.
struct MoveCounts {
    std::uint64_t commands = 0;    ///< G, M and T commands
    std::uint64_t travels = 0;     ///< moves without extrusion
    std::uint64_t stationary = 0;  ///< extrusion without plan motion: primes and un-retractions
    std::uint64_t beads = 0;
};

/// Executes lines one after another and hands extruding moves to a BeadRecorder.
///
/// Print space is the coordinate frame in force when the first bead is laid: G92 X/Y/Z before that (touching off)
/// renames the place, after it moves the frame, so that a program that prints the same lines again elsewhere does.
class Machine {
public:
    /// `name` stands in messages. `settings` and `recorder` must outlive the machine.
    Machine(const Settings& settings, const ReadOptions& options, std::string_view name, BeadRecorder& recorder,
            WarningLog& warnings);

    /// Throws InputError "name:line: ..." for numbers that can't be meant.
    void run(const Line& line);

    const MoveCounts& counts() const { return counts_; }
    Firmware firmware() const { return firmware_; }
    double filamentDiameter() const { return filamentDiameter(0); }
    double filamentMm() const { return filament_mm_; }
    double extrudedMm3() const { return extruded_mm3_; }

private:
    void execute(const Command& command);
    void executeG(const Command& command);
    void executeM(const Command& command);
    void executeExtended(const Command& command);
    void selectTool(const Command& command);
    void move(const Command& command, int motion);
    std::optional<Arc> arcOf(const Command& command, const Point& target, bool clockwise);
    void deposit(const Point& target, const std::optional<Arc>& arc, double length, double extrusion);
    void home(const Command& command);
    void setPosition(const Command& command);
    void setAbsolute(bool absolute);
    void setVolumetric(const Command& command);
    void setFlow(const Command& command);
    void labelObject(const Command& command);

    double takeAxis(const Command& command, char letter, double current, double offset) const;
    double takeExtrusion(const Command& command);
    void assumeExtruderMode();
    /// The part of a push or pull of E that isn't spent on fetching unloaded filament back to the nozzle.
    double leavesNozzle(double drive, bool in_place);
    double eUnit() const { return volumetric_ ? unit_ * unit_ * unit_ : unit_; }
    double filamentDiameter(std::size_t tool) const;
    double filamentArea() const;
    [[noreturn]] void refuse(std::string_view what) const;
    void warn(std::string_view text) { warnings_.add(text, line_); }

    const Settings& settings_;
    std::string_view name_;
    BeadRecorder& recorder_;
    WarningLog& warnings_;
    Firmware firmware_ = Firmware::marlin;
    std::optional<double> filament_override_;
    std::optional<double> m200_diameter_;

    std::uint32_t line_ = 0;
    Point position_;
    Point offset_;  // print space minus the program's coordinates
    double e_ = 0;
    double unit_ = 1;  // mm in one unit of the program
    int motion_ = 0;   // the G0..G3 in force, for lines without a command
    bool absolute_ = true;
    bool e_absolute_ = true;
    bool e_mode_known_ = false;    // by M82, M83, an option, or assumed
    bool e_follows_axes_ = false;  // G90 or G91 has set it by Marlin's rule
    bool volumetric_ = false;
    std::size_t tool_ = 0;
    std::array<double, 256> flow_;
    std::array<double, 256> drawn_back_{};  // mm of filament, by tool
    std::array<bool, 256> unloaded_{};
    bool objects_by_comment_ = false;

    MoveCounts counts_;
    double filament_mm_ = 0;
    double extruded_mm3_ = 0;
};

/// "marlin", "klipper" or "reprap"; "automatic" is none of them.
std::string_view firmwareName(Firmware firmware);

}  // namespace stratum::gcode
