// Where a model lies in a print: slicers move and turn it, and few say how.
#pragma once

#include "compare/closed_model.h"
#include "compare/rigid.h"
#include "compare/surface_samples.h"

#include <optional>

namespace stratum::compare {

struct Fit {
    Rigid model_to_print;
    double residual = 0;  ///< mm: RMS of the distances of the samples that count
    std::size_t samples = 0;
    bool converged = true;  ///< false: the model is of another size; only the middles are brought together
};

constexpr std::size_t kFewestSamples = 100;

/// How many samples to take where `count` is usual: fewer of a model whose triangles lie across each other, as those of
/// a damaged file, so that each search looks at thousands.
std::size_t affordable(const ClosedModel& model, const SurfaceSamples& print, std::size_t count);

/// Iterated closest points, to the planes of the nearest triangles (Chen and Medioni, Image and Vision Computing 10,
/// 1992), without what is farther than three times the distance that nine
/// tenths of the samples keep. It starts
/// from both surfaces' centroids with 24 turns about z, and if none of them fits with those of the other five sides
/// down. The best few starts of the first side, and of the others together, are refined. Of placements that fit equally
/// well, as those of a cube, that with the smallest turn. Parallel; the result does not depend on the number of
/// threads. Throws UsageError if there are fewer samples than kFewestSamples.
Fit fitModel(const ClosedModel& model, const SurfaceSamples& print);

/// Where the model lies roughly, from 12 turns about z of each side; nothing unless one of the starts comes nearer than
/// `near` (mm, RMS) in the first, coarse ones.
std::optional<Rigid> roughFit(const ClosedModel& model, const SurfaceSamples& print, double near);

/// mm: RMS of the distances of the samples that count, at a placement; of the samples that fitModel() begins with.
double roughResidual(const ClosedModel& model, const SurfaceSamples& print, const Rigid& model_to_print);

/// The same from a placement that is nearly right.
Fit refineFit(const ClosedModel& model, const SurfaceSamples& print, const Rigid& model_to_print);

}  // namespace stratum::compare
