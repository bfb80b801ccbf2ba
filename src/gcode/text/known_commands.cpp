#include "gcode/text/known_commands.h"

#include "base/text.h"

#include <algorithm>
#include <bitset>
#include <cstddef>
#include <vector>

namespace stratum::gcode {
namespace {

// What homes, probes, levels, waits, cleans, or sets things that no bead depends on. By firmware; those that several
// have stand with the first.
constexpr std::string_view kHarmlessG =
    // Marlin
    "4 11-12 26-27 29-35 38 40 42 49 76 80 94 425 "
    // Prusa: G64 and G65 probe, G162 and G163 measure axes
    "64-65 123 427 "
    // MakerBot and Sailfish: G130 sets motor currents, G161 and G162 home
    "130 161-163 "
    // Repetier
    "100 131-135 "
    // Bambu: G39, G2814 and G383 probe, G150 cleans the nozzle, G380 lowers the bed, G392 guards against clumps
    "39 150-152 180-181 211 221 380-384 392 2814 "
    // Ultimaker: primes by itself
    "280 "
    // Anycubic: heats, homes, levels and primes by itself
    "9111-9112";

constexpr std::string_view kHarmlessM =
    // Marlin, Klipper, RepRapFirmware. M2 to M9 end a program or turn tools of other trades on and off.
    "0-9 16-40 42-43 48-49 70-87 92-93 99-102 104-129 134-136 140-151 154-155 163-166 190-193 201-205 207-218 220 "
    "226-228 240-256 260-261 280-310 350-351 355-364 380-381 400-430 440-442 500-605 665-674 701-713 851-919 "
    "928-999 7219 "
    // Prusa
    "262-268 330-334 340 920-921 1200 1600-1604 1700-1704 1959 1977-1978 9140-9150 9200-9202 "
    // MakerBot and Sailfish: M130 to M133 wait and load home positions, M137 ends, M320 to M323 are about acceleration
    "130-133 137 320-323 "
    // Repetier
    "450-453 460 606 "
    // Bambu
    "481 620-645 1000-1030 9711-9833 "
    // FlashForge: purges and switches of the machine
    "650-661 "
    // Creality, Elegoo, Anycubic, Raise3D: lights, cutters, boxes of filament, names of modes
    "729 2000-2012 2202 4010 6211 8200-8233 "
    // 3DGence: what of the start program is done
    "3006 3290 "
    // MKS: pictures in a comment; Ultimaker: pauses and calibrations
    "10086 12000-12001";

constexpr std::size_t kMostCodes = 12288;
using Codes = std::bitset<kMostCodes>;

Codes codesOf(std::string_view ranges) {
    Codes codes;
    for (const std::string_view range : split(ranges, ' ')) {
        const std::vector<std::string_view> ends = split(range, '-');
        const auto last = parsed<std::size_t>(ends.back());
        for (auto code = parsed<std::size_t>(ends.front()); code <= last; ++*code) codes.set(*code);
    }
    return codes;
}

// Beginnings of names, upper case.
constexpr std::string_view kHarmlessMacros =
    // Klipper
    "ANGLE_ AXIS_TWIST_ BED_MESH_ BED_SCREWS BED_TILT BLTOUCH_ CANCEL_PRINT CLEAR_PAUSE DELTA_ DUMP_TMC "
    "ENDSTOP_PHASE EXCLUDE_OBJECT_DEFINE FIRMWARE_RESTART GET_POSITION INIT_TMC INPUT_SHAPER LOAD_CELL PALETTE_ "
    "PAUSE PID_CALIBRATE PROBE_ QUERY_ QUAD_GANTRY_LEVEL RESONANCE_ RESPOND RESUME SAVE_CONFIG SAVE_VARIABLE "
    "SCREWS_TILT SDCARD_ SET_DISPLAY_ SET_EXTRUDER_ SET_FAN_SPEED SET_FILAMENT_SENSOR SET_GCODE_VARIABLE "
    "SET_HEATER_TEMPERATURE SET_IDLE_TIMEOUT SET_INPUT_SHAPER SET_LED SET_PIN SET_PRESSURE_ADVANCE "
    "SET_PRINT_STATS_INFO SET_RETRACTION SET_SERVO SET_SKEW SET_STEPPER_ SET_TEMPERATURE_FAN_TARGET SET_TMC_ "
    "SET_VELOCITY_LIMIT SHAPER_CALIBRATE SKEW_PROFILE SYNC_EXTRUDER_ TEMPERATURE_WAIT TUNING_TOWER TURN_OFF_HEATERS "
    "UPDATE_DELAYED_GCODE Z_OFFSET_APPLY_ Z_TILT_ADJUST "
    // Macros that come behind the print, or count it
    "END_PRINT PRINT_END TIMELAPSE_ "
    // Happy Hare and other changers of filament: statements about the print
    "MMU_START_";

}  // namespace

bool isHarmlessMacro(std::string_view name) {
    static const std::vector<std::string_view> starts = split(kHarmlessMacros, ' ');
    return std::any_of(starts.begin(), starts.end(), [name](std::string_view start) {
        return name.size() >= start.size() &&
               std::equal(start.begin(), start.end(), name.begin(), [](char a, char b) { return a == upperCase(b); });
    });
}

bool isHarmless(char letter, std::int32_t code) {
    static const Codes g = codesOf(kHarmlessG);
    static const Codes m = codesOf(kHarmlessM);
    const auto index = static_cast<std::size_t>(code);
    return index < kMostCodes && (letter == 'G' ? g : m).test(index);
}

}  // namespace stratum::gcode
