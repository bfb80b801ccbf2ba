#include "gcode/text/known_commands.h"

#include "base/text.h"

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

// 380 is Bambu's way of lowering the bed to its end stop.
constexpr std::array<std::int32_t, 17> kHarmlessG{4, 11, 12, 26, 27, 29, 30, 31, 32, 33, 34, 35, 40, 49, 80, 94, 380};

struct Range {
    std::int32_t first;
    std::int32_t last;
};

// Ascending. M2-M9 end a program or turn tools of other trades on and off.
constexpr std::array<Range, 37> kHarmlessM{{
    {0, 9},     {16, 40},   {42, 43},   {70, 87},     {92, 93},     {100, 102}, {104, 119}, {120, 123},
    {125, 129}, {134, 136}, {140, 146}, {149, 150},   {154, 155},   {163, 166}, {190, 193}, {201, 205},
    {207, 208}, {211, 218}, {220, 220}, {226, 228},   {240, 256},   {260, 261}, {280, 310}, {350, 351},
    {355, 360}, {380, 381}, {400, 430}, {440, 441},   {500, 599},   {600, 605}, {620, 630}, {665, 674},
    {701, 713}, {851, 918}, {928, 999}, {1001, 1007}, {9711, 9833},
}};

// Beginnings of names, upper case.
constexpr std::array<std::string_view, 25> kHarmlessMacros{
    "BED_MESH_",
    "CLEAR_PAUSE",
    "EXCLUDE_OBJECT_DEFINE",
    "GET_POSITION",
    "PROBE_",
    "QUERY_",
    "QUAD_GANTRY_LEVEL",
    "RESPOND",
    "SCREWS_TILT",
    "SET_DISPLAY_TEXT",
    "SET_FAN_SPEED",
    "SET_FILAMENT_SENSOR",
    "SET_HEATER_TEMPERATURE",
    "SET_IDLE_TIMEOUT",
    "SET_INPUT_SHAPER",
    "SET_LED",
    "SET_PIN",
    "SET_PRESSURE_ADVANCE",
    "SET_PRINT_STATS_INFO",
    "SET_RETRACTION",
    "SET_VELOCITY_LIMIT",
    "TEMPERATURE_WAIT",
    "TIMELAPSE_",
    "TURN_OFF_HEATERS",
    "Z_TILT_ADJUST",
};

}  // namespace

bool isHarmlessMacro(std::string_view name) {
    return std::any_of(kHarmlessMacros.begin(), kHarmlessMacros.end(), [name](std::string_view start) {
        return name.size() >= start.size() &&
               std::equal(start.begin(), start.end(), name.begin(), [](char a, char b) { return a == upperCase(b); });
    });
}

bool isHarmless(char letter, std::int32_t code) {
    if (letter == 'G') return std::binary_search(kHarmlessG.begin(), kHarmlessG.end(), code);
    return std::any_of(kHarmlessM.begin(), kHarmlessM.end(),
                       [code](const Range& range) { return code >= range.first && code <= range.last; });
}

}  // namespace stratum::gcode
