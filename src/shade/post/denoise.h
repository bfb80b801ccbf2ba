// Taking the noise out of a finished film: a separate step, and a biased one.
#pragma once

#include "shade/film/film.h"
#include "shade/integrator/render.h"

namespace stratum::shade {

/// What a picture's metadata must say of it.
extern const char* const kDenoiserLabel;

/// Whether denoise() knows what to do with that integrator's pictures: those of path and direct.
bool canDenoise(const IntegratorOptions& integrator);

/// Adds the layers that denoise() is guided by to what is rendered (normal, depth, albedo, shading and variance), and a
/// margin about a crop, so that its pixels become those of the whole picture. Throws UsageError for integrators other
/// than path and direct, and for a single sample a pixel.
void addDenoisingGuides(RenderOptions& options);

/// Replaces the film's colors by estimates with less noise, and keeps the old ones as a layer "noisy". Alpha stays.
///
/// Each pixel is the value at its place of a linear function, fitted by least squares to the pixels around it, of the
/// place, of what the light makes of the surfaces' directions (Aov::shading), and of their albedo. They weigh by how
/// alike the light of the patches about them is beyond what their variance explains, so that shadows keep their edges,
/// and by how alike normals, albedo and depth are. Layer lines are in the guides, so that the fit keeps them.
/// Unlike the render itself this is biased: where neither guides nor light tell two surfaces apart, it mixes them.
/// A pixel's result depends on the pixels up to kDenoisingMargin from it. Deterministic; the same bytes for any number
/// of threads. About a microsecond of one core a pixel with AVX-512.
/// Sources: F. Rousselle, C. Knaus, M. Zwicker, "Adaptive Rendering with Non-Local Means Filtering", SIGGRAPH Asia
/// 2012 (distance of patches); B. Moon, N. Carr, S.-E. Yoon, "Adaptive Rendering based on Weighted Local Regression",
/// TOG 33(5) 2014, and B. Bitterli et al., "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo
/// Renderings", EGSR 2016 (regression on guides).
/// Throws std::invalid_argument if a guide is missing. What `progress` throws is passed on.
void denoise(Film& film, const Progress& progress = {});

/// Pixels: a neighbour, a patch about it, and a mean of variances about that.
extern const int kDenoisingMargin;

}  // namespace stratum::shade
