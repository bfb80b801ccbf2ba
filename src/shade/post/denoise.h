// Denoises a finished film: a separate, biased step.
#pragma once

#include "shade/film/film.h"
#include "shade/integrator/render.h"

namespace stratum::shade {

/// The text for the metadata of denoised pictures.
extern const char* const kDenoiserLabel;

/// Whether denoise() supports that integrator's pictures: those of path and direct.
bool canDenoise(const IntegratorOptions& integrator);

/// Adds the guide layers of denoise() to the render options (normal, depth, albedo, shading and variance), and a margin
/// around a crop, so that its pixels become those of the whole picture. Throws UsageError for integrators other than
/// path and direct, and for a single sample a pixel.
void addDenoisingGuides(RenderOptions& options);

/// Replaces the film's colors by estimates with less noise, and keeps the old ones as a layer "noisy". Alpha is not
/// changed, but for that of shadows in a transparent film (Film::bareBed()): it is fitted like a color, and colors are
/// compared as those of the picture with a bed.
///
/// Each pixel is the value of a linear function of position, Aov::shading and albedo, fitted by weighted least squares
/// to the pixels around it, and no less than the least of the 3 x 3 pixels. The weights decrease with the
/// difference in color of the patches around two pixels, beyond the difference that their variance explains, so that
/// shadows keep their edges; and with differences in normals, albedo and depth. Layer lines are in the guides, so the
/// fit keeps them. Unlike the render itself this is biased: it blurs details that neither guides nor colors
/// distinguish. A pixel's result depends on the pixels up to kDenoisingMargin from it. Deterministic; the same bytes
/// for any number of threads. About a microsecond of one core a pixel with AVX-512. Sources: F. Rousselle, C. Knaus, M.
/// Zwicker, "Adaptive Rendering with Non-Local Means Filtering", SIGGRAPH Asia 2012 (distance of patches); B. Moon, N.
/// Carr, S.-E. Yoon, "Adaptive Rendering based on Weighted Local Regression", TOG 33(5) 2014, and B. Bitterli et al.,
/// "Nonlinearly Weighted First-order Regression for Denoising Monte Carlo Renderings", EGSR 2016 (regression on
/// guides). Throws std::invalid_argument if a guide is missing. What `progress` throws is passed on.
void denoise(Film& film, const Progress& progress = {});

/// Pixels: the radius of neighbours, plus that of a patch, plus that of the mean of variances.
extern const int kDenoisingMargin;

}  // namespace stratum::shade
