// Taking the noise out of a finished film: a separate step, and a biased one.
#pragma once

#include "shade/film.h"
#include "shade/render.h"

namespace stratum::shade {

/// What a picture's metadata must say of it.
extern const char* const kDenoiserLabel;

/// Adds the layers that denoise() is guided by to what is rendered: normal, depth, albedo and variance. Throws
/// UsageError for integrators other than path and direct.
void addDenoisingGuides(RenderOptions& options);

/// Replaces the film's colours by estimates with less noise, and keeps the old ones as a layer "noisy". Alpha stays.
///
/// Each pixel is the value at its place of a linear function of the guides and of the place, fitted by least squares to
/// the pixels around it. They weigh by how alike the light of the patches about them is beyond what their variance
/// explains, so that shadows keep their edges, and by how alike their guides are, so that layer lines keep theirs.
/// Unlike the render itself this is biased: where neither guides nor light tell two surfaces apart, it mixes them.
/// Deterministic; the same bytes for any number of threads.
/// Sources: F. Rousselle, C. Knaus, M. Zwicker, "Adaptive Rendering with Non-Local Means Filtering", SIGGRAPH Asia
/// 2012 (distance of patches); B. Moon, N. Carr, S.-E. Yoon, "Adaptive Rendering based on Weighted Local Regression",
/// TOG 33(5) 2014, and B. Bitterli et al., "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo
/// Renderings", EGSR 2016 (regression on guides).
/// Throws std::invalid_argument if a guide is missing.
void denoise(Film& film);

}  // namespace stratum::shade
