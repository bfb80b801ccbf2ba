// The .binary files of the MERL database.
#pragma once

#include "shade/brdf/half_diff_table.h"

#include <filesystem>
#include <string_view>

namespace stratum::shade {

/// Whether the first bytes are the three sizes of such a file.
bool isMerl(std::string_view bytes);

/// Three int32 (90, 90, 180), then doubles, little-endian: all red, all green, all blue, scaled by 1500, 1500/1.15 and
/// 1500/1.66. Cells without a measurement (negative) get the value of the same cell with a smaller half angle.
/// Source: W. Matusik et al., SIGGRAPH 2003, and the reader that comes with the database.
/// Throws InputError.
HalfDiffTable readMerl(std::string_view bytes, std::string_view name);

/// Writes one, atomically. Throws OutputError.
void writeMerl(const std::filesystem::path& path, const HalfDiffTable& table);

}  // namespace stratum::shade
