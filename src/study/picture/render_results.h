// The rows of render.csv, variant by variant, and what the page tells of them.
#pragma once

#include "study/picture/references.h"
#include "study/picture/render_plan.h"
#include "study/report/page.h"

#include <map>
#include <string>
#include <vector>

namespace stratum::study {

/// Columns of render.csv; the first kRenderKeys are the key of a row.
extern const Row kRenderColumns;
inline constexpr std::size_t kRenderKeys = 7;

/// Rows of one variant and number of samples, over its seeds.
struct RenderPoint {
    int spp = 0;
    double wall = 0, cpu = 0;      ///< medians, seconds
    double error = 0, spread = 0;  ///< mean relMSE, and its standard deviation over the seeds
    double fine = 0;               ///< mean relMSE against the finest voxels' reference
    double flip = 0, flip_spread = 0;
    std::size_t line = 0;  ///< of render.csv, its first row
    std::string run;
};

class RenderResults {
public:
    RenderResults(const std::vector<Row>& rows, const ResultTable& table);

    /// Ascending by samples.
    const std::vector<RenderPoint>& of(const std::string& variant) const { return points_.at(variant); }
    /// `name`: of the legend; empty: the variant's. With bars of a standard deviation where there is one of `y`.
    Series series(const std::string& variant, double RenderPoint::*x, double RenderPoint::*y,
                  const std::string& name = {}, bool dashed = false, int color = -1) const;

private:
    std::map<std::string, std::vector<RenderPoint>> points_;
};

/// FLIP of both, displayed as `picture` is: shares are not tone-mapped, and a reference doesn't know that it is one of
/// shares.
double flipOf(const shade::Film& reference, const shade::Film& picture);

/// Plots of error and FLIP over time.
void addComparison(Page& page, const RenderResults& results, const char* title,
                   const std::vector<std::string>& variants);
/// The error of the voxels alone, as the references show it, beside the noise.
void addVoxels(Page& page, const RenderResults& results, const RenderPlan& plan, References& references);
void addSlopes(Page& page, const RenderResults& results, const std::vector<Variant>& variants);
void addEverything(Page& page, const RenderResults& results, const std::vector<Variant>& variants);

}  // namespace stratum::study
