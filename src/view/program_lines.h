// Lines of the G-code around one of them.
#pragma once

#include "assemble/print/print_levels.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::view {

struct ProgramLine {
    std::uint32_t number = 0;  ///< from 1
    std::string text;          ///< without its end; cut after a few hundred bytes, with anything but ASCII replaced
};

/// The lines number - around to number + around, as far as they are there. Reads the file, and unpacks it if it must
/// be. Throws InputError.
std::vector<ProgramLine> linesAround(const std::string& path, const voxelize::PrintOptions& options,
                                     std::uint32_t number, std::uint32_t around);

/// The same as JSON for a page, four lines before and after.
nlohmann::json linesAround(const std::string& path, const voxelize::PrintOptions& options, std::uint32_t number);

}  // namespace stratum::view
