// The table of prints in `vdbstudy polygons`, and what its page says of it.
#pragma once

#include "study/report/page.h"
#include "study/report/result_table.h"
#include "study/study.h"

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace stratum::study {

/// Columns of polygons_prints.csv.
enum PrintColumn : std::size_t {
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
inline constexpr int kComparedSamples = 32;  ///< a pixel: what totals are told for

/// A cell as a number; NaN if it is empty.
double valueOf(const Row& row, PrintColumn column);

/// What pictures are made by.
struct PrintIntegrator {
    std::string name;  ///< as shade::IntegratorOptions has it
    std::string what;  ///< in words
};

/// All rows of one print and integrator.
struct PrintResult {
    std::string name;
    std::vector<Row> rows;           ///< one a representation
    std::vector<std::size_t> lines;  ///< of polygons_prints.csv, of those rows
    std::vector<Row> sweep;          ///< segments cut in all ways; empty for most prints
    std::filesystem::path picture;   ///< may be missing
    double enclosed = 0;             ///< cm3

    /// Null where there is none.
    const Row* find(const std::string& kind) const;
    /// The one of the least CPU time, of the level sets or of the peers: of those that are exact enough for a picture
    /// of `spp` samples (1: a first look, or kComparedSamples), if any. Null where no time was measured.
    const Row* best(bool level_sets, int spp) const;
};

/// Small, middle or large.
const char* sizeClassOf(double cm3);

/// Plots, the verdict on level sets against the best peer, and everything measured. `kinds`: representations in the
/// order of the legend.
void addPrints(Page& page, const PrintIntegrator& integrator, const std::vector<PrintResult>& results,
               const std::vector<std::string>& kinds, StudyReport& report);

}  // namespace stratum::study
