#include "gcode/slicer/mixed_colors.h"

#include "base/srgb.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace stratum::gcode {
namespace {

constexpr double kDarkest = 0.003;

std::uint8_t srgbByte(double linear) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(srgbOfLinear(linear), 0.0, 1.0)));
}

}  // namespace

Rgb mixedColor(std::span<const Rgb> colors, std::span<const double> shares) {
    // One alone stays to the bit, also if it is darker than the bound.
    for (std::size_t n = 0; n < colors.size(); ++n)
        if (shares[n] >= 1) return colors[n];
    Rgb mixed{};
    for (std::size_t channel = 0; channel < mixed.size(); ++channel) {
        double ratio = 0;  // K/S
        for (std::size_t n = 0; n < colors.size(); ++n) {
            const double r = std::clamp(linearOfSrgb(colors[n][channel] / 255.0), kDarkest, 1 - kDarkest);
            ratio += shares[n] * (1 - r) * (1 - r) / (2 * r);
        }
        mixed[channel] = srgbByte(1 + ratio - std::sqrt(ratio * ratio + 2 * ratio));
    }
    return mixed;
}

std::size_t addMixes(std::span<const MixChange> mixes, std::span<const std::optional<Rgb>> filaments,
                     Toolpath& toolpath) {
    std::size_t left_out = 0;
    for (const MixChange& mix : mixes) {
        std::vector<Rgb> colors;
        std::vector<double> shares;
        bool known = true;
        for (std::size_t n = 0; n < mix.shares.size(); ++n) {
            if (!(mix.shares[n] > 0)) continue;
            known = known && n < filaments.size() && filaments[n];
            if (!known) break;
            colors.push_back(*filaments[n]);
            shares.push_back(mix.shares[n]);
        }
        if (known)
            toolpath.color_changes.push_back({mix.first_bead, mix.tool, mixedColor(colors, shares)});
        else
            ++left_out;
    }
    std::stable_sort(toolpath.color_changes.begin(), toolpath.color_changes.end(),
                     [](const ColorChange& a, const ColorChange& b) { return a.first_bead < b.first_bead; });
    return left_out;
}

}  // namespace stratum::gcode
