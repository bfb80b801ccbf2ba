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
    kIntegrator,
    kLight,
    kSize,
    kSpp,
    kThreads,
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
    kFirstLook,  ///< convert, build and a picture of one sample a pixel, in a process of their own
    kConvertWall,
    kBuildWall,
    kRenderWall,
    kFirstLookWall,
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

/// What pictures are made by.
struct SeedIntegrator {
    std::string name;  ///< as shade::IntegratorOptions has it
    std::string what;  ///< in words
};

/// All rows of one print and integrator.
struct SeedPrintResult {
    std::string name;
    std::vector<Row> rows;          ///< one a representation
    std::vector<Row> sweep;         ///< segments cut in all ways; empty for most prints
    std::filesystem::path picture;  ///< may be missing
    double enclosed = 0;            ///< cm3

    /// Null where there is none.
    const Row* find(const std::string& kind) const;
    /// The one of the least CPU time, of the level sets or of the peers: of those that are exact enough for a picture
    /// of `spp` samples (1: a first look, or kSeedSamples), if any. Null where no time was measured.
    const Row* best(bool level_sets, int spp) const;
};

/// Small, middle or large.
const char* seedClassOf(double cm3);

/// Plots, the verdict on level sets against the best peer, and everything measured. `kinds`: representations in the
/// order of the legend.
void addSeedPrints(Page& page, const SeedIntegrator& integrator, const std::vector<SeedPrintResult>& results,
                   const std::vector<std::string>& kinds, StudyReport& report);

}  // namespace stratum::study
