// What Cura alone writes, and what one must know beside it: the user's own settings, as Cura stores them for reading a
// profile back, and the limits of the machines that it plans for.
// Sources: Cura's GCodeWriter.py (";SETTING_3 " and a piece of JSON, whose strings are profiles with one "key = value"
// a line); Cura 15's util/profile.py (";CURA_PROFILE_STRING:", base64 of zlib: "key=value" separated by \b, and after
// \f the texts of start and end programs).
#pragma once

#include "gcode/printer/motion.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::gcode {

struct CuraSetting {
    std::optional<std::size_t> extruder;  ///< nothing: of the whole print
    std::string key;
    std::string value;
};

/// Collects them from comments in the order of the file.
class CuraProfile {
public:
    /// `comment` is one line behind its ';', untrimmed. False if it is no part of a profile.
    bool comment(std::string_view comment);

    /// What was collected; damaged parts are left out. To be called once, at the end.
    std::vector<CuraSetting> settings();

    /// Some ";CURA_PROFILE_STRING:" has been read.
    bool isCura15() const { return cura_15_; }
    /// A profile string couldn't be decoded.
    bool isDamaged() const { return damaged_; }

private:
    void readProfileString(std::string_view base64);

    std::string json_;  // of all SETTING_3 lines
    std::vector<CuraSetting> settings_;
    bool cura_15_ = false;
    bool damaged_ = false;
};

// The limits by which Cura plans the times that it writes: those of its definition of the machine, which a file names.
// Sources (facts only): resources/definitions/*.def.json of Cura 4.13 and 5 (machine_max_feedrate_*,
// machine_max_acceleration_*, machine_acceleration, machine_max_jerk_*); CuraEngine's timeEstimate.cpp.

/// Whether the name is a machine of the table; `machine` as TARGET_MACHINE.NAME or the id of a definition has it
/// ("Creality Ender-3", "creality_ender3").
bool isCuraMachine(std::string_view machine);

/// Limits of that machine; of fdmprinter, which all definitions build on, for any other name. The rule is plan_jerk.
MachineLimits curaLimits(std::string_view machine);

/// Replaces one limit by a changed setting ("machine_max_acceleration_x", "machine_acceleration"). False for other keys
/// and impossible values.
bool setCuraLimit(std::string_view key, std::string_view value, MachineLimits& limits);

}  // namespace stratum::gcode
