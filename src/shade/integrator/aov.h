// Arbitrary output variables (AOVs): layers of a film beside its color, for compositing, denoising and computer vision.
#pragma once

#include "shade/film/film.h"
#include "shade/integrator/bare_light.h"
#include "shade/integrator/integrator.h"
#include "shade/scene/surface.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// One kind of layer. Layers of geometry are means over all samples, with 0 for samples that hit nothing: premultiplied
/// by coverage, as the film's colors are.
enum class Aov {
    normal,    ///< X, Y, Z: world-space unit normal that faces the camera
    depth,     ///< Z: world units along the ray
    position,  ///< X, Y, Z: world space
    albedo,    ///< R, G, B: reflectanceFactor of the material
    shading,   ///< M, G: BareLight::matt and gloss of the surface's normal; where there are flakes, with their glint
    mask,      ///< V: share of the pixel that the print covers
    variance,  ///< V: variance of the pixel's mean luminance, estimated from its samples as if they were independent;
               ///< stratified samples do better, so it is an upper estimate
    samples,   ///< V: samples taken
    // Ids are not averaged: the id of the first sample that hits the print; -1 if none does.
    layer,    ///< V: number of the layer
    tool,     ///< V: T number
    feature,  ///< V: see gcode2vdb --grids
};

/// All of them, as parseAovs() takes them.
std::vector<std::string> aovNames();

/// The layers of --aov: "normal,depth,...". Throws UsageError.
std::vector<Aov> parseAovs(std::string_view text);

/// The labels that these layers need scene.labels for.
std::vector<Label> labelsOf(const std::vector<Aov>& aovs);

/// Empty layers of a film of this many pixels.
std::vector<FilmLayer> makeLayers(const std::vector<Aov>& aovs, std::size_t pixels);

/// How many sums of one pixel these layers need, in their order.
std::size_t sumsOf(const std::vector<Aov>& aovs);

/// Values of a pixel that the renderer supplies.
struct PixelStatistics {
    double variance = 0.0;
    std::uint32_t samples = 0;
};

/// Writes the means of one pixel, whose sums these are, into the film's layers.
void storeAovs(const std::vector<Aov>& aovs, std::span<const double> sums, const PixelStatistics& statistics,
               std::vector<FilmLayer>& layers, std::size_t pixel);

/// Records the first hits of camera rays. Immutable; shared by all threads.
class AovRecorder {
public:
    AovRecorder(const SceneDescription& scene, const trace::Intersector& print, std::vector<Aov> aovs);
    const std::vector<Aov>& aovs() const { return aovs_; }
    /// Film::bareBed() of the scene.
    float bareBed() const { return bare_bed_; }
    /// Adds one sample, the first hit of a camera ray of that direction (t is infinite if none), to the sums of a
    /// pixel.
    void add(const SurfacePoint& point, const glm::dvec3& direction, std::span<double> sums) const;

private:
    /// Light that flakes at a point mirror, beyond the gloss of its surface; 0 without flakes.
    float glintOf(const SurfacePoint& point, const glm::dvec3& direction) const;

    Surfaces surfaces_;
    std::vector<Aov> aovs_;
    std::optional<BareLight> bare_light_;  // only for Aov::shading
    float bare_bed_;
};

}  // namespace stratum::shade
