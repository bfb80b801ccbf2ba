// Limits of a printer from the files that firmwares have them in.
#pragma once

#include "base/options/json_section.h"
#include "gcode/printer/read_options.h"

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace stratum::deposit {

// The limits of a printer from Klipper's configuration: its sections and options as Klipper itself reads them.
// Source: klippy/configfile.py of August 2026 and the grammar of Python's RawConfigParser that it relies on: ':' and
// '=' between option and value, '#' begins a comment anywhere, ';' at the begin or behind a blank, indented lines go on
// with a value, the last of equal options counts, [include GLOB] is read in place, and options of the SAVE_CONFIG block
// hold where the rest does not state them.

class KlipperConfig {
public:
    struct Value {
        std::string text;
        std::string place;  ///< "printer.cfg:12"
    };

    /// Reads `text`, which is the file `path`, and what it includes, relative to its folder. Throws InputError with
    /// file and line for what Klipper would refuse, and beyond 1000 files or 8 MB of them.
    KlipperConfig(const std::string& path, std::string_view text);

    bool has(std::string_view section) const { return sections_.find(section) != sections_.end(); }
    /// nullptr if it is not stated. `option` is in lower case.
    const Value* find(std::string_view section, std::string_view option) const;

private:
    using Options = std::map<std::string, Value, std::less<>>;
    std::map<std::string, Options, std::less<>> sections_;
    friend class KlipperReader;
};

/// Whether some line is the head of a section.
bool looksLikeKlipperConfig(std::string_view text);

// The limits.
// Sources: klippy/toolhead.py, kinematics/*.py, kinematics/extruder.py and extras/gcode_arcs.py of August 2026:
// options, defaults and bounds; klippy/toolhead.py of March 2024 for max_accel_to_decel.

/// Limits that the file leaves out are Klipper's defaults; without a section [extruder] those of moves of E alone are
/// assumed. [extruder1] and further ones are not read. Throws InputError with file and line.
gcode::PrinterLimits readKlipperLimits(const std::string& path, std::string_view text);

// The limits of a printer from commands: RepRapFirmware's config.g, or what Marlin answers to M503.
// Sources: RepRapFirmware 3.5's GCodes2.cpp and GCodes5.cpp (M92, M201, M203 with S1, M204, M205, M566) and its
// Configuration.h for defaults; marlinfw.org/docs/gcode/M503.html and reports of Marlin 1.0 to 2.1 that people posted.

/// Whose commands a text has; nothing if it has no limit of a machine in it.
/// Throws InputError for a program that prints.
std::optional<gcode::Firmware> firmwareOfCommands(const std::string& path, std::string_view text);

/// Limits that a config.g leaves out are RepRapFirmware's defaults; those that a report leaves out are not given. Of
/// several extruders the first counts. A report with junction deviation (M205 J) is by that rule; one with jerk by
/// Marlin 2's, or by Marlin 1's where its headings are none of Marlin 2's comments.
/// @param firmware  reprap or marlin
/// Throws InputError with file and line.
gcode::PrinterLimits readCommandLimits(const std::string& path, std::string_view text, gcode::Firmware firmware);

// The limits of a printer in the project's own JSON.

/// @param section  the object "limits"; docs/printers.md has its keys
/// @param bytes    the whole file, for the lines of the keys
/// Throws InputError for unknown keys and impossible values, with their place.
gcode::PrinterLimits readJsonLimits(JsonSection section, std::string_view bytes);

}  // namespace stratum::deposit
