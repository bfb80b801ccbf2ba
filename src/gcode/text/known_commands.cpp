#include "gcode/text/known_commands.h"

#include "base/text.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <span>

namespace stratum::gcode {
namespace {

struct Range {
    std::int32_t first;
    std::int32_t last;
};

// What homes, probes, levels, waits, cleans, or sets things that no bead depends on. By firmware; those that several
// have stand with the first.
constexpr std::array kHarmlessG{
    // Marlin
    Range{4, 4},
    Range{11, 12},
    Range{26, 27},
    Range{29, 35},
    Range{38, 38},
    Range{40, 40},
    Range{42, 42},
    Range{49, 49},
    Range{76, 76},
    Range{80, 80},
    Range{94, 94},
    Range{425, 425},
    // Prusa: G64 and G65 probe, G162 and G163 measure axes
    Range{64, 65},
    Range{123, 123},
    Range{427, 427},
    // MakerBot and Sailfish: G130 sets motor currents, G161 and G162 home
    Range{130, 130},
    Range{161, 163},
    // Repetier
    Range{100, 100},
    Range{131, 135},
    // Bambu: G39, G2814 and G383 probe, G150 cleans the nozzle, G380 lowers the bed, G392 guards against clumps
    Range{39, 39},
    Range{150, 152},
    Range{180, 181},
    Range{211, 211},
    Range{221, 221},
    Range{380, 384},
    Range{392, 392},
    Range{2814, 2814},
    // Ultimaker: primes by itself
    Range{280, 280},
    // Anycubic: heats, homes, levels and primes by itself
    Range{9111, 9112},
};

constexpr std::array kHarmlessM{
    // Marlin, Klipper, RepRapFirmware. M2 to M9 end a program or turn tools of other trades on and off.
    Range{0, 9},
    Range{16, 40},
    Range{42, 43},
    Range{48, 49},
    Range{70, 87},
    Range{92, 93},
    Range{99, 102},
    Range{104, 129},
    Range{134, 136},
    Range{140, 151},
    Range{154, 155},
    Range{163, 166},
    Range{190, 193},
    Range{201, 205},
    Range{207, 218},
    Range{220, 220},
    Range{226, 228},
    Range{240, 256},
    Range{260, 261},
    Range{280, 310},
    Range{350, 351},
    Range{355, 364},
    Range{380, 381},
    Range{400, 430},
    Range{440, 442},
    Range{500, 605},
    Range{665, 674},
    Range{701, 713},
    Range{851, 919},
    Range{928, 999},
    Range{7219, 7219},
    // Prusa
    Range{262, 268},
    Range{330, 334},
    Range{340, 340},
    Range{920, 921},
    Range{1200, 1200},
    Range{1600, 1604},
    Range{1700, 1704},
    Range{1959, 1959},
    Range{1977, 1978},
    Range{9140, 9150},
    Range{9200, 9202},
    // MakerBot and Sailfish: M130 to M133 wait and load home positions, M137 ends, M320 to M323 are about acceleration
    Range{130, 133},
    Range{137, 137},
    Range{320, 323},
    // Repetier
    Range{450, 453},
    Range{460, 460},
    Range{606, 606},
    // Bambu
    Range{481, 481},
    Range{620, 645},
    Range{1000, 1030},
    Range{9711, 9833},
    // FlashForge: purges and switches of the machine
    Range{650, 661},
    // Creality, Elegoo, Anycubic, Raise3D: lights, cutters, boxes of filament, names of modes
    Range{729, 729},
    Range{2000, 2012},
    Range{2202, 2202},
    Range{4010, 4010},
    Range{6211, 6211},
    Range{8200, 8233},
    // MKS: pictures in a comment; Ultimaker: pauses and calibrations
    Range{10086, 10086},
    Range{12000, 12001},
};

constexpr std::size_t kMostCodes = 12288;
using Codes = std::bitset<kMostCodes>;

Codes codesOf(std::span<const Range> ranges) {
    Codes codes;
    for (const Range& range : ranges)
        for (std::int32_t code = range.first; code <= range.last; ++code) codes.set(static_cast<std::size_t>(code));
    return codes;
}

// Beginnings of names, upper case.
constexpr std::array<std::string_view, 62> kHarmlessMacros{
    // Klipper
    "ANGLE_",
    "AXIS_TWIST_",
    "BED_MESH_",
    "BED_SCREWS",
    "BED_TILT",
    "BLTOUCH_",
    "CANCEL_PRINT",
    "CLEAR_PAUSE",
    "DELTA_",
    "DUMP_TMC",
    "ENDSTOP_PHASE",
    "EXCLUDE_OBJECT_DEFINE",
    "FIRMWARE_RESTART",
    "GET_POSITION",
    "INIT_TMC",
    "INPUT_SHAPER",
    "LOAD_CELL",
    "PALETTE_",
    "PAUSE",
    "PID_CALIBRATE",
    "PROBE_",
    "QUERY_",
    "QUAD_GANTRY_LEVEL",
    "RESONANCE_",
    "RESPOND",
    "RESUME",
    "SAVE_CONFIG",
    "SAVE_VARIABLE",
    "SCREWS_TILT",
    "SDCARD_",
    "SET_DISPLAY_",
    "SET_EXTRUDER_",
    "SET_FAN_SPEED",
    "SET_FILAMENT_SENSOR",
    "SET_GCODE_VARIABLE",
    "SET_HEATER_TEMPERATURE",
    "SET_IDLE_TIMEOUT",
    "SET_INPUT_SHAPER",
    "SET_LED",
    "SET_PIN",
    "SET_PRESSURE_ADVANCE",
    "SET_PRINT_STATS_INFO",
    "SET_RETRACTION",
    "SET_SERVO",
    "SET_SKEW",
    "SET_STEPPER_",
    "SET_TEMPERATURE_FAN_TARGET",
    "SET_TMC_",
    "SET_VELOCITY_LIMIT",
    "SHAPER_CALIBRATE",
    "SKEW_PROFILE",
    "SYNC_EXTRUDER_",
    "TEMPERATURE_WAIT",
    "TUNING_TOWER",
    "TURN_OFF_HEATERS",
    "UPDATE_DELAYED_GCODE",
    "Z_OFFSET_APPLY_",
    "Z_TILT_ADJUST",
    // Macros that come behind the print, or count it
    "END_PRINT",
    "PRINT_END",
    "TIMELAPSE_",
    // Happy Hare and other changers of filament: statements about the print
    "MMU_START_",
};

}  // namespace

bool isHarmlessMacro(std::string_view name) {
    return std::any_of(kHarmlessMacros.begin(), kHarmlessMacros.end(), [name](std::string_view start) {
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
