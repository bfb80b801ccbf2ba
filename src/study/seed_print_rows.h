// The table of prints in `vdbstudy seeds`, and what its page says of it.
#pragma once

#include "study/page.h"
#include "study/result_table.h"
#include "study/study.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace stratum::study {

/// Columns of seeds_prints.csv.
enum SeedPrintColumn : std::size_t {
    kPrint,
    kHash,
    kLight,
    kSize,
    kSpp,
    kKind,
    kExtruded,
    kEnclosed,
    kPrimitives,
    kBytes,
    kPeak,
    kRead,
    kConvert,
    kBuild,
    kRender,
    kConvertWall,
    kBuildWall,
    kRenderWall,
    kRays,
    kNoise,
    kBias,
    kSeries
};

/// What representations that are level sets are called, or begin with.
inline constexpr const char* kLevelSet = "level set";
inline constexpr int kSeedSamples = 32;  ///< a pixel: what totals are told for

/// A cell as a number; NaN if it is empty.
double seedValue(const Row& row, SeedPrintColumn column);

/// All rows of one print.
struct SeedPrintResult {
    std::string name;
    std::vector<Row> rows;          ///< one a representation
    std::vector<Row> sweep;         ///< segments cut in all ways; empty for most prints
    std::filesystem::path picture;  ///< may be missing
    double enclosed = 0;            ///< cm3

    /// Null where there is none.
    const Row* find(const std::string& kind) const;
    /// The fastest in all of the level sets, or of the peers: of those that are exact enough for the picture, if any.
    const Row* best(bool level_sets) const;
};

/// Small, middle or large.
const char* seedClassOf(double cm3);

/// Plots, the verdict on level sets against the best peer, and everything measured. `kinds`: representations in the
/// order of the legend.
void addSeedPrints(Page& page, const std::vector<SeedPrintResult>& results, const std::vector<std::string>& kinds,
                   StudyReport& report);

}  // namespace stratum::study
