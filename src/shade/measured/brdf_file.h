// Reads measured materials from files of all supported formats.
#pragma once

#include "shade/brdf/brdf_scan.h"
#include "shade/brdf/half_diff_table.h"
#include "shade/brdf/table_brdf.h"

#include <filesystem>
#include <memory>
#include <string>
#include <variant>

namespace stratum::shade {

/// The contents of a file, before a complete BRDF is made from it.
struct MeasuredMaterial {
    std::string kind;  ///< of file
    std::variant<BrdfScan, HalfDiffTable> data;
};

/// Reads only, without making a BRDF. Throws InputError.
MeasuredMaterial readMeasuredMaterial(const std::filesystem::path& path);

/// Reads Mini-Diff (LightTools), Zemax or ASTM E1392 text, also gzip-compressed, a MERL .binary or an EXR texture,
/// recognized by content, and makes a BRDF from it: scans by ScanInterpolant, baked to a HalfDiffTable; MERL tables
/// unchanged. notes() has the source and remarks. Uses all threads. Throws InputError.
std::shared_ptr<const TableBrdf> readBrdfFile(const std::filesystem::path& path);

/// Writes the table as MERL's if the name ends in .binary, as an EXR texture at 0, 20, 40 and 60 degrees if in .exr.
/// Throws UsageError for another ending, OutputError.
void writeBrdfFile(const std::filesystem::path& path, const Brdf& brdf);

}  // namespace stratum::shade
