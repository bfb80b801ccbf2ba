// Small programs for the tests of this room.
#pragma once

#include "base/error.h"
#include "gcode/reader.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// Cross-section of the filament that is assumed where nothing is said.
inline constexpr double kFilamentArea = std::numbers::pi / 4 * 1.75 * 1.75;

inline Toolpath readProgram(std::string_view program, const ReadOptions& options = {}) {
    return readToolpath(program, "test.gcode", options);
}

/// The message of the InputError that reading throws; fails the test and returns "" if it doesn't.
inline std::string inputErrorOf(std::string_view program) {
    try {
        readProgram(program);
    } catch (const InputError& error) {
        return error.what();
    }
    ADD_FAILURE() << "no InputError";
    return "";
}

/// How often the warning whose text contains `part` was given; 0 if never.
inline std::uint32_t warningCount(const Toolpath& toolpath, std::string_view part) {
    for (const Warning& warning : toolpath.warnings)
        if (warning.text.find(part) != std::string::npos) return warning.count;
    return 0;
}

/// Volume a bead holds, mm^3.
inline double volumeOf(const Toolpath& toolpath, const Bead& bead) {
    return sectionArea(static_cast<double>(bead.width), static_cast<double>(toolpath.runOf(bead).height)) *
           beadLength(toolpath, bead);
}

}  // namespace stratum::gcode
