#include "study/picture/flip.h"

#include "base/parallel_for.h"
#include "base/srgb.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace stratum::study {

const double kFlipPixelsPerDegree = 0.7 * (3840 / 0.7) * std::numbers::pi / 180;

namespace {

using Plane = std::vector<double>;

// Colour spaces. sRGB's primaries and white by their chromaticities (IEC 61966-2-1).
glm::dvec3 fromChromaticity(double x, double y) { return {x / y, 1, (1 - x - y) / y}; }

glm::dmat3 rgbToXyz() {
    const glm::dmat3 primaries(fromChromaticity(0.64, 0.33), fromChromaticity(0.30, 0.60),
                               fromChromaticity(0.15, 0.06));
    const glm::dvec3 scale = glm::inverse(primaries) * fromChromaticity(0.3127, 0.3290);
    return {primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z};
}

struct Spaces {
    glm::dmat3 to_xyz = rgbToXyz();
    glm::dmat3 from_xyz = glm::inverse(to_xyz);
    glm::dvec3 white = to_xyz * glm::dvec3(1);

    // An opponent space that is linear in light: CIELAB without its cube root.
    glm::dvec3 opponent(const glm::dvec3& rgb) const {
        const glm::dvec3 v = to_xyz * rgb / white;
        return {116 * v.y - 16, 500 * (v.x - v.y), 200 * (v.y - v.z)};
    }
    glm::dvec3 fromOpponent(const glm::dvec3& o) const {
        const double y = (o.x + 16) / 116;
        return from_xyz * (glm::dvec3(y + o.y / 500, y, y - o.z / 200) * white);
    }
    // CIELAB, chroma scaled by lightness: colours that are dark look less colourful (Hunt).
    glm::dvec3 huntLab(const glm::dvec3& rgb) const {
        const auto root = [](double t) {
            constexpr double kDelta = 6.0 / 29;
            return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0 / 29;
        };
        const glm::dvec3 v = to_xyz * rgb / white;
        const double y = root(v.y);
        const double lightness = 116 * y - 16;
        return {lightness, 0.01 * lightness * 500 * (root(v.x) - y), 0.01 * lightness * 200 * (y - root(v.z))};
    }
};

// For large differences of colour: city block in lightness, Euclid in chroma.
double hyab(const glm::dvec3& a, const glm::dvec3& b) { return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z); }

// A row of weights, the middle one for the pixel itself.
using Kernel = std::vector<double>;

Kernel gaussian(double variance, int radius) {
    Kernel kernel;
    double sum = 0;
    for (int k = -radius; k <= radius; ++k) {
        kernel.push_back(std::exp(-0.5 * k * k / variance));
        sum += kernel.back();
    }
    for (double& weight : kernel) weight /= sum;
    return kernel;
}

// Scaled so that what is positive in it sums to 1, and what is negative to -1.
void balance(Kernel& kernel) {
    double up = 0;
    double down = 0;
    for (const double weight : kernel) (weight > 0 ? up : down) += std::abs(weight);
    for (double& weight : kernel) weight /= weight > 0 ? up : down;
}

// One after the other along rows and columns. Beyond the edges the outermost pixels go on.
Plane convolve(const Plane& in, int width, int height, const Kernel& along_x, const Kernel& along_y) {
    const auto pass = [&](const Plane& from, const Kernel& kernel, bool rows) {
        Plane to(from.size());
        const int radius = static_cast<int>(kernel.size() / 2);
        parallelFor(static_cast<std::size_t>(height), 8, [&](std::size_t first, std::size_t last) {
            for (int y = static_cast<int>(first); y < static_cast<int>(last); ++y)
                for (int x = 0; x < width; ++x) {
                    double sum = 0;
                    for (std::size_t n = 0; n < kernel.size(); ++n) {
                        const int k = static_cast<int>(n) - radius;
                        const int fx = rows ? std::clamp(x + k, 0, width - 1) : x;
                        const int fy = rows ? y : std::clamp(y + k, 0, height - 1);
                        sum += kernel[n] * from[static_cast<std::size_t>(fy) * static_cast<std::size_t>(width) +
                                                static_cast<std::size_t>(fx)];
                    }
                    to[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
                        sum;
                }
        });
        return to;
    };
    return pass(pass(in, along_x, true), along_y, false);
}

// The eye's contrast sensitivity to one opponent channel: a sum of a_i sqrt(pi / b_i) exp(-pi^2 r^2 / b_i), r in
// degrees, of sum 1 over the grid.
struct Sensitivity {
    std::array<double, 2> a, b;
};
constexpr std::array<Sensitivity, 3> kSensitivity{
    {{{1, 0}, {0.0047, 1e-5}}, {{1, 0}, {0.0053, 1e-5}}, {{34.1, 13.5}, {0.04, 0.025}}}};

Plane filtered(const Plane& channel, int width, int height, const Sensitivity& s, double pixels_per_degree) {
    // As far as three standard deviations of the widest of all.
    const int radius = static_cast<int>(
        std::ceil(3 * std::sqrt(0.04 / (2 * std::numbers::pi * std::numbers::pi)) * pixels_per_degree));
    Plane sum(channel.size(), 0.0);
    std::array<double, 2> share{};  // of each Gaussian in the kernel's sum over the grid
    std::array<Kernel, 2> kernels;
    double whole = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const double variance =
            s.b[i] / (2 * std::numbers::pi * std::numbers::pi) * pixels_per_degree * pixels_per_degree;
        double line = 0;
        for (int k = -radius; k <= radius; ++k) line += std::exp(-0.5 * k * k / variance);
        share[i] = s.a[i] * std::sqrt(std::numbers::pi / s.b[i]) * line * line;
        whole += share[i];
        kernels[i] = gaussian(variance, radius);
    }
    for (std::size_t i = 0; i < 2; ++i) {
        if (!(share[i] > 0)) continue;
        const Plane part = convolve(channel, width, height, kernels[i], kernels[i]);
        for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += share[i] / whole * part[n];
    }
    return sum;
}

// What the two halves of the metric see of one picture.
struct Seen {
    std::vector<glm::dvec3> colors;  // filtered, Hunt-adjusted CIELAB
    Plane edges, points;             // strength of features of luminance
};

Seen look(const DisplayPicture& picture, const Spaces& spaces, double pixels_per_degree) {
    const std::size_t count = picture.pixels.size();
    std::array<Plane, 3> channels;
    for (Plane& channel : channels) channel.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
        glm::dvec3 rgb;
        for (int c = 0; c < 3; ++c)
            rgb[c] = linearOfSrgb(std::clamp(static_cast<double>(picture.pixels[n][c]), 0.0, 1.0));
        const glm::dvec3 opponent = spaces.opponent(rgb);
        for (std::size_t c = 0; c < 3; ++c) channels[c][n] = opponent[static_cast<int>(c)];
    }
    Plane luminance = channels[0];
    for (double& v : luminance) v = (v + 16) / 116;
    for (std::size_t c = 0; c < 3; ++c)
        channels[c] = filtered(channels[c], picture.width, picture.height, kSensitivity[c], pixels_per_degree);
    Seen seen;
    seen.colors.resize(count);
    for (std::size_t n = 0; n < count; ++n) {
        const glm::dvec3 rgb = spaces.fromOpponent({channels[0][n], channels[1][n], channels[2][n]});
        seen.colors[n] = spaces.huntLab(glm::clamp(rgb, 0.0, 1.0));
    }
    // Edges and points: first and second derivatives of a Gaussian as wide as the eye's feature detectors.
    constexpr double kFeatureWidth = 0.082;  // degrees
    const double deviation = 0.5 * kFeatureWidth * pixels_per_degree;
    const double variance = deviation * deviation;
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    const Kernel smooth = gaussian(variance, radius);
    Kernel first = smooth;
    Kernel second = smooth;
    for (std::size_t n = 0; n < smooth.size(); ++n) {
        const int k = static_cast<int>(n) - radius;
        first[n] *= -k;
        second[n] *= k * k / variance - 1;
    }
    balance(first);
    balance(second);
    const auto strength = [&](const Kernel& kernel) {
        Plane x = convolve(luminance, picture.width, picture.height, kernel, smooth);
        const Plane y = convolve(luminance, picture.width, picture.height, smooth, kernel);
        for (std::size_t n = 0; n < count; ++n) x[n] = std::hypot(x[n], y[n]);
        return x;
    };
    seen.edges = strength(first);
    seen.points = strength(second);
    return seen;
}

}  // namespace

std::vector<float> flipMap(const DisplayPicture& reference, const DisplayPicture& picture, double pixels_per_degree) {
    if (reference.width != picture.width || reference.height != picture.height)
        throw std::invalid_argument("pictures of different sizes");
    constexpr double kColorPower = 0.7;
    constexpr double kFeaturePower = 0.5;
    // Differences up to 0.4 of the largest take 0.95 of the scale.
    constexpr double kBend = 0.4;
    constexpr double kBendTo = 0.95;
    const Spaces spaces;
    const double largest = std::pow(hyab(spaces.huntLab({0, 1, 0}), spaces.huntLab({0, 0, 1})), kColorPower);
    const Seen a = look(reference, spaces, pixels_per_degree);
    const Seen b = look(picture, spaces, pixels_per_degree);
    std::vector<float> map(a.colors.size());
    for (std::size_t n = 0; n < map.size(); ++n) {
        const double difference = std::pow(hyab(a.colors[n], b.colors[n]), kColorPower);
        const double bend = kBend * largest;
        const double color = difference < bend ? kBendTo / bend * difference
                                               : kBendTo + (difference - bend) / (largest - bend) * (1 - kBendTo);
        const double feature = std::pow(
            std::max(std::abs(a.edges[n] - b.edges[n]), std::abs(a.points[n] - b.points[n])) / std::numbers::sqrt2,
            kFeaturePower);
        map[n] = static_cast<float>(std::pow(std::clamp(color, 0.0, 1.0), 1 - std::min(feature, 1.0)));
    }
    return map;
}

double meanFlip(const DisplayPicture& reference, const DisplayPicture& picture, double pixels_per_degree) {
    const std::vector<float> map = flipMap(reference, picture, pixels_per_degree);
    double sum = 0;
    for (const float v : map) sum += static_cast<double>(v);
    return map.empty() ? 0 : sum / static_cast<double>(map.size());
}

}  // namespace stratum::study
