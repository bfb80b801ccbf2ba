// The machine simulator: commands -> positions, extrusion, beads.
//
// Lengths are mm, E is mm of filament or mm^3, feed rates mm/s. The machine starts at 0. The methods are in machine.cpp
// (commands that set state), machine_motion.cpp (moves and extrusion) and machine_macro.cpp (Klipper's named commands).
// Sources: marlinfw.org/docs/gcode (G0-G5, G10, G17-G20, G28, G53-G61, G90, G92, M82, M200, M206, M218, M220, M221,
// M486); docs.duet3d.com (G1 R, G10, G53, G60, G92, M221, M486) and klipper3d.org/G-Codes.html (G90/G91 leave E alone
// there).
#pragma once

#include "gcode/machine/bead_recorder.h"
#include "gcode/machine/belt.h"
#include "gcode/machine/carriages.h"
#include "gcode/machine/extra_axes.h"
#include "gcode/machine/motion_recorder.h"
#include "gcode/printer/mixer.h"
#include "gcode/printer/read_options.h"
#include "gcode/slicer/settings.h"
#include "gcode/text/lexer.h"
#include "gcode/toolpath/arc.h"
#include "gcode/toolpath/frame.h"
#include "gcode/toolpath/warning_log.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace stratum::gcode {

/// Statistics for messages.
struct MoveCounts {
    std::uint64_t commands = 0;    ///< G, M and T commands
    std::uint64_t travels = 0;     ///< moves without extrusion
    std::uint64_t stationary = 0;  ///< extrusion without plan motion: primes and un-retractions
    std::uint64_t beads = 0;
};

/// From which bead on which flow (M221, times ReadOptions::flow_percent) made the plastic of its E.
struct FlowChange {
    std::size_t first_bead = 0;
    double factor = 1;
};

/// Executes lines one after another and hands extruding moves to a BeadRecorder. Print space is Frame's.
class Machine {
public:
    /// `name` is used in messages. `settings` and `recorder` must outlive the machine.
    Machine(const Settings& settings, const ReadOptions& options, std::string_view name, BeadRecorder& recorder,
            WarningLog& warnings);

    /// Sends all further motion to this recorder, which must outlive the machine.
    void recordMotion(MotionRecorder* moves) { moves_ = moves; }

    /// Throws InputError "name:line: ..." for impossible numbers.
    void run(const Line& line);

    const MoveCounts& counts() const { return counts_; }
    Firmware firmware() const { return firmware_; }
    double filamentDiameter(std::size_t tool) const;
    /// False if E's volume depends on a diameter that neither an option, nor the settings, nor M200 gave.
    bool filamentKnown() const;
    /// In words: the unit of E at the end, and its source.
    std::string extrusionRule() const;
    double filamentMm() const { return filament_mm_; }
    /// mm that were pushed out in place between a slicer's marks of flushing.
    double flushedMm() const { return flushed_; }
    double extrudedMm3() const { return extruded_mm3_; }
    /// In the order of the beads; 1 before the first.
    const std::vector<FlowChange>& flowChanges() const { return flow_changes_; }

private:
    // Saved by SAVE_GCODE_STATE.
    struct Saved {
        Frame frame;
        double e = 0;
        double feed = 0;
        double speed_factor = 1;
        std::array<double, 256> flow{};
        bool absolute = true;
        bool e_absolute = true;
    };

    // Stored by G60.
    struct Stored {
        Point position;
        double e = 0;
    };

    void execute(const Command& command);
    void executeG(const Command& command);
    void executeM(const Command& command);
    void executeMacro(const Command& command);
    void selectTool(const Command& command);
    void useNumberedTool(double number);
    void changeMakerBotTool(double number);
    void useTool(std::size_t tool);
    void heed(const Tag& tag, const Line& line);
    /// All filament that was drawn back is at the nozzle again.
    void loaded();
    void setOffsets(const Command& command);
    void storePosition(const Command& command);
    void returnToPosition(const Command& command);
    void setPosition(const Command& command);
    void setAbsolute(const Command& command);
    void remarkForeign(const Command& command);
    void tellElapsed(std::string_view comment);
    void flushByItself(std::string_view comment);
    void warnUnreadable(const Line& line);
    void warnNoWords();
    void setHeatOrFan(const Command& command);
    void setAdvance(const Command& command, char seconds, char tool);
    void setHomeOffset(const Command& command);
    void setVolumetric(const Command& command);
    void setSpeedFactor(const Command& command);
    void setFlow(const Command& command);
    void labelObject(const Command& command);
    void mixFilaments(const Command& command);
    void home(const Command& command);
    double coordinateOf(const Command& command, char letter) const;

    void setMacroOffset(std::string_view text);
    void saveState(std::string_view text);
    void restoreState(std::string_view text);
    /// A move that a named command makes, at `speed` mm/s, or at the speed in force.
    void recordReturn(const Point& target, std::optional<double> speed);

    void move(const Command& command, int motion);
    /// Whether the firmware refuses a move with letters that have no number; warns of them in any case.
    bool refusesLetters(const Command& command);
    /// The straight or, in the bed plane, circular path to the target.
    void runPath(const Point& target, const std::optional<Arc>& arc, double extrusion);
    void runPieces(const std::vector<Point>& pieces, double extrusion);
    void runTurns(const Point& target, const Arc& arc, int turns, double extrusion);
    void runArc(const Command& command, const Point& target, bool clockwise, double extrusion);
    void runBezier(const Command& command, const Point& target, double extrusion);
    std::optional<Arc> arcOf(const Command& command, const Point& target, bool clockwise);
    void deposit(const Point& target, const std::optional<Arc>& arc, double length, double extrusion);
    /// Adds filament (mm, as the file counts it) to the sums of a tool.
    void count(std::size_t tool, double filament);
    void lay(const Point& from, const Point& to, std::optional<Arc> arc, double length, double volume);
    void layCopy(const Point& target, const std::optional<Arc>& arc, double length, double volume, double filament);
    /// Whether that extrusion makes a thread of that length in the air.
    bool isThread(double extrusion, double length) const;
    /// A thread that goes straight up.
    void runStrut(const Point& target, double extrusion, double drive);
    /// The part of a movement of E that is not needed to take back what was drawn back.
    double freshOf(double drive) const;
    void moveExtraAxes(const Command& command);
    void checkExtraAxes();
    double switchedExtrusion(double length);
    void timeArc(const Arc& arc, const Point& target, int turns);
    void recordTravel(const Command& command, const Point& target, int motion, double drive);
    void recordPath(const Point& target, const std::optional<Arc>& arc, double drive, std::size_t beads_before);

    void setVelocityLimit(std::string_view text);
    void setPressureAdvance(std::string_view text);

    double takeAxis(const Command& command, char letter, std::size_t axis) const;
    /// The stored position that RepRapFirmware's R word selects, or nullptr.
    const Point* restorePoint(const Command& command, int motion);
    /// The stored position on the axes in the command, each plus its number; the current position on the others.
    Point targetFrom(const Point& stored, const Command& command) const;
    double takeExtrusion(const Command& command);
    /// The letter whose number drives an extruder: E, or A or B on machines with these; 0 if the command has none.
    char extruderAxis(const Command& command) const;
    /// Switches to the tool of axis A or B; does nothing for other letters.
    void useExtruderOf(char axis);
    void assumeExtruderMode();
    /// The part of a movement of E that is not needed to bring unloaded filament back to the nozzle.
    double extrudedOf(double drive, bool in_place);
    double eUnit() const { return volumetric_ ? unit_ * unit_ * unit_ : unit_; }
    double filamentArea() const;
    [[noreturn]] void refuse(std::string_view what) const;
    void warn(std::string_view text) { warnings_.add(text, line_); }

    const Settings& settings_;
    std::string_view name_;
    BeadRecorder& recorder_;
    WarningLog& warnings_;
    Firmware firmware_ = Firmware::marlin;
    std::vector<double> filament_override_;
    std::map<std::size_t, double> m200_diameters_;  // mm, by tool
    std::string volumetric_reason_;
    double nominal_height_;

    std::uint32_t line_ = 0;
    Frame frame_;
    Plane plane_;
    double e_ = 0;
    bool e_begun_ = false;                 // something has moved it
    std::array<double, 256> e_by_tool_{};  // when MakerBot's commands changed it
    std::optional<double> tool_e_;         // of the tool since then, until an E tells whether it counts
    double unit_ = 1;                      // mm in one unit of the program
    int motion_ = 0;                       // the G0..G3 or G5 in force, for lines without a command
    bool absolute_ = true;
    bool e_absolute_ = true;
    bool e_mode_known_ = false;    // from M82, M83, an option, or an assumption
    bool e_follows_axes_ = false;  // the mode was set by G90 or G91 (Marlin's rule)
    bool inverse_time_ = false;    // F is 1 / minutes of the move (G93)
    bool m83_ = false;             // the last of M82 and M83 was M83
    bool volumetric_ = false;
    bool motor_on_ = false;  // between M101 and M103, in files without E
    // Homes by G161 and G162: a workspace is then the place of a tool's nozzle in the head, which the slicer has
    // subtracted, and G92 holds in all of them (GPX, gpx.c).
    bool makerbot_ = false;
    std::size_t tool_ = 0;
    std::size_t beads_at_tool_ = 0;  // when it was chosen
    Mixer mixer_;
    double feed_ = 0;
    double move_seconds_ = 60;  // of a move under G93
    double speed_factor_ = 1;
    double speed_backup_ = 1;
    const double all_flow_;         // ReadOptions::flow_percent as a factor
    std::array<double, 256> flow_;  // by tool, with all_flow_
    std::vector<FlowChange> flow_changes_;
    std::array<double, 256> drawn_back_{};  // mm of filament, by tool
    std::array<bool, 256> unloaded_{};
    const bool planar_;
    const bool simulates_flow_;
    std::optional<Belt> belt_;
    bool flushing_ = false;
    bool types_stated_ = false;  // comments of their own name features
    double flushed_ = 0;         // mm
    ExtraAxes extra_axes_;
    Carriages carriages_;
    std::map<std::string, Saved, std::less<>> saved_;
    std::map<int, Stored> stored_;  // by slot
    bool objects_by_comment_ = false;
    int object_number_ = -1;                                  // of the current object by M486; -1: none
    std::map<int, std::string> object_names_;                 // by number, as M486 A has named them
    std::unordered_map<std::string, std::size_t> name_uses_;  // how many of them have it
    MotionRecorder* moves_ = nullptr;                         // nullptr: motion is not recorded
    double drive_per_extrusion_ = 0;  // of the current move: movement of E over extrusion at the nozzle

    MoveCounts counts_;
    double filament_mm_ = 0;
    double extruded_mm3_ = 0;
};

/// "marlin", "klipper" or "reprap"; "automatic" is none of them.
std::string_view firmwareName(Firmware firmware);

}  // namespace stratum::gcode
