#include "shade/scene/paper_tone.h"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::shade {
namespace {

glm::dvec3 labOf(const Color& color) {
    // Rec. 709 primaries to CIE XYZ, by the white point D65 (IEC 61966-2-1).
    const glm::dvec3 c(color);
    const glm::dvec3 white(0.95047, 1.0, 1.08883);
    const glm::dvec3 xyz(0.4124564 * c.r + 0.3575761 * c.g + 0.1804375 * c.b,
                         0.2126729 * c.r + 0.7151522 * c.g + 0.0721750 * c.b,
                         0.0193339 * c.r + 0.1191920 * c.g + 0.9503041 * c.b);
    const auto root = [](double t) {
        constexpr double kLow = 216.0 / 24389.0;
        return t > kLow ? std::cbrt(t) : (24389.0 / 27.0 * t + 16.0) / 116.0;
    };
    const glm::dvec3 f(root(xyz.x / white.x), root(xyz.y / white.y), root(xyz.z / white.z));
    return {116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z)};
}

double nearest(std::span<const Color> parts, const Color& paper) {
    double least = std::numeric_limits<double>::infinity();
    for (const Color& part : parts) least = std::min(least, colorDifference(part, paper));
    return least;
}

}  // namespace

double colorDifference(const Color& a, const Color& b) { return glm::length(labOf(a) - labOf(b)); }

Color paperFor(std::span<const Color> parts) {
    const Color light = BedTexture(BedSurface::paper).mean();
    const double away = nearest(parts, light);
    if (away >= kLeastDifference) return light;
    float least = std::numeric_limits<float>::infinity();
    for (const Color& part : parts)
        if (colorDifference(part, light) < kLeastDifference) least = std::min(least, luminance(part));
    const Color dark(0.25f * least);
    return nearest(parts, dark) > away ? dark : light;
}

void matchPaper(SceneDescription& scene, BedSurface surface) {
    if (!scene.bed || scene.transparent || surface != BedSurface::paper) return;
    std::vector<Color> parts;
    for (const ObjectMaterial& object : scene.objects) {
        if (object.ofPlastic().empty()) return;
        for (const Material& material : object.ofPlastic()) parts.push_back(material.albedo);
    }
    if (parts.empty()) parts.push_back(reflectanceFactor(*scene.material));
    const Color before = scene.bed->texture.mean();
    const Color paper = paperFor(parts);
    if (paper == before) return;
    scene.bed->texture = BedTexture(paper);
    if (!scene.backdrop) return;
    // Both are what the paper reflects.
    scene.backdrop->horizon *= paper / before;
    scene.backdrop->zenith *= paper / before;
}

}  // namespace stratum::shade
