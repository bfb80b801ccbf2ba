// How fast pictures come near the truth: error against run time.
#pragma once

#include "study/study.h"

#include <string>
#include <vector>

namespace stratum::study {

struct RenderStudyOptions {
    std::string print;  ///< a G-code file
    std::vector<int>
        per_layer;  ///< voxel sizes, voxels a layer; the finest is what the others are held against. Empty:
                    ///< 1, 2, 4, 8, or 1, 2 if quick. The middle one, by size, serves all other comparisons
    int seeds = 0;  ///< pictures of each kind that differ by their noise alone; 0: 5, or 2 if quick
};

/// render.csv and render.html: relative squared error and mean FLIP against references, over wall and CPU time, for
/// intersectors, integrators, ways to sample, voxel sizes, and with and without the denoiser. The references, 64 times
/// as many samples as the best picture and numbers of their own, are kept in the folder `references` beside them.
/// Throws InputError, UsageError, OutputError.
StudyReport studyRender(const RenderStudyOptions& options, const StudyOptions& common);

}  // namespace stratum::study
