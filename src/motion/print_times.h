// Real times of a print: of each bead, each layer, each feature, and in total.
#pragma once

#include "gcode/reader.h"
#include "gcode/toolpath/toolpath.h"
#include "motion/planner.h"
#include "motion/travels.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::motion {

/// Seconds, by the machine's limits and the rule of its planner. Heating, homing and probing take an unknown time and
/// are not counted.
struct PrintTimes {
    double total = 0;
    double travel = 0;                                    ///< of moves without extrusion
    double retraction = 0;                                ///< of moves of E alone: retracting, priming
    double waiting = 0;                                   ///< G4, changes of tool
    double before_model = 0;                              ///< until the first bead of layer 1: the start program
    double after_model = 0;                               ///< behind the last bead: the end program
    std::array<double, gcode::kFeatureCount> features{};  ///< of beads
    std::vector<double> layers;  ///< by layer number; travel before a bead belongs to its layer, the rest to the last
    std::string rule;            ///< a ruleName(), or what it is multiplied by
    gcode::LimitOrigins limits;  ///< those that were planned with, before the program's first command
};

/// The times by the rule that the slicer estimated by, where the firmware plans by another one: PrusaSlicer and its
/// kin, and Cura, estimate for Klipper as for any printer, Simplify3D and Kiri:Moto for any without acceleration.
/// `times` and `toolpath` are what readTimedToolpath() found with these options. nullopt: no other rule, one that was
/// asked for, a printer that was given, or no stated time to compare with. Reads the program again.
std::optional<PrintTimes> estimatedTimes(std::string_view bytes, std::string_view name,
                                         const gcode::ReadOptions& options, const PrintTimes& times,
                                         const gcode::Toolpath& toolpath);

/// What a file states of its time, and what is planned of the same part of the program.
struct StatedTime {
    double stated = 0;   ///< s; 0: the file states none
    double planned = 0;  ///< s; without the start program if the stated time is the model's alone (BambuStudio), and
                         ///< without the end program, too, where the slicer doesn't read them (Cura)
};
StatedTime statedTime(const PrintTimes& times, const gcode::StatedFacts& facts);

/// The name of a rule on command lines and in reports; "auto" is automatic.
std::string_view ruleName(gcode::CornerRule rule);

/// Reads a program and plans its motion: fills Toolpath::timing and returns the sums. `also`, if not null, gets the
/// plan too, and `travels` the moves that lay nothing. Throws what readToolpath() throws. Takes about twice as long as
/// reading alone, and 24 bytes a bead.
gcode::Toolpath readTimedToolpath(std::string_view bytes, std::string_view name, const gcode::ReadOptions& options,
                                  PrintTimes& times, PlanSink* also = nullptr, std::vector<Travel>* travels = nullptr);

}  // namespace stratum::motion
