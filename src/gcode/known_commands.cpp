#include "gcode/known_commands.h"

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

constexpr std::array<std::int32_t, 17> kHarmlessG{4, 12, 17, 26, 27, 29, 30, 31, 32, 33, 34, 35, 40, 49, 53, 80, 94};

struct Range {
    std::int32_t first;
    std::int32_t last;
};

// Ascending. M2-M9 end a program or turn tools of other trades on and off.
constexpr std::array<Range, 34> kHarmlessM{{
    {0, 9},     {16, 40},   {42, 43},   {70, 87},   {92, 93},   {100, 102}, {104, 119},   {120, 123}, {125, 129},
    {134, 136}, {140, 146}, {149, 150}, {154, 155}, {163, 166}, {190, 193}, {201, 205},   {211, 217}, {220, 220},
    {226, 228}, {240, 256}, {260, 261}, {280, 310}, {350, 351}, {355, 360}, {380, 381},   {400, 430}, {440, 441},
    {500, 599}, {600, 605}, {665, 674}, {701, 713}, {851, 918}, {928, 999}, {1001, 1002},
}};

}  // namespace

bool isHarmless(char letter, std::int32_t code) {
    if (letter == 'G') return std::binary_search(kHarmlessG.begin(), kHarmlessG.end(), code);
    return std::any_of(kHarmlessM.begin(), kHarmlessM.end(),
                       [code](const Range& range) { return code >= range.first && code <= range.last; });
}

}  // namespace stratum::gcode
