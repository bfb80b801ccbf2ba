#include "gcode/slicer/bead_colors.h"

#include "base/category_colors.h"
#include "base/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

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

namespace {

Rgb paletteColor(std::size_t n) {
    const std::uint32_t color = kCategoryColors[n % kCategoryColors.size()];
    return {static_cast<std::uint8_t>(color >> 16U), static_cast<std::uint8_t>(color >> 8U),
            static_cast<std::uint8_t>(color)};
}

// The first change of filament behind a bead.
auto changesUpTo(const Toolpath& toolpath, std::size_t bead) {
    const auto& changes = toolpath.color_changes;
    return std::upper_bound(changes.begin(), changes.end(), bead,
                            [](std::size_t b, const ColorChange& c) { return b < c.first_bead; });
}

// Sweeps over the beads in print order, so that every change is looked at once. A bead before the last one starts anew.
class Sweep {
public:
    explicit Sweep(const Toolpath& toolpath) : toolpath_(toolpath) {}

    const StatedColor& at(std::uint32_t bead) {
        const auto& changes = toolpath_.color_changes;
        if (bead < last_) {
            done_ = 0;
            by_tool_ = {};
        }
        last_ = bead;
        for (; done_ < changes.size() && changes[done_].first_bead <= bead; ++done_)
            by_tool_[changes[done_].tool] =
                StatedColor{changes[done_].color, changes[done_].tool, true, !changes[done_].stated};
        const std::uint8_t tool = toolpath_.runOf(toolpath_.beads[bead]).tool;
        if (!by_tool_[tool]) by_tool_[tool] = colorOfTool(toolpath_, tool);
        return *by_tool_[tool];
    }

private:
    const Toolpath& toolpath_;
    std::array<std::optional<StatedColor>, 256> by_tool_{};
    std::size_t done_ = 0;
    std::uint32_t last_ = 0;
};

}  // namespace

StatedColor colorOfTool(const Toolpath& toolpath, std::uint8_t tool) {
    const std::vector<std::uint8_t>& palette = toolpath.palette_tools;
    StatedColor stated{std::nullopt, tool, false, std::find(palette.begin(), palette.end(), tool) != palette.end()};
    if (tool < toolpath.tool_colors.size()) stated.color = toolpath.tool_colors[tool];
    return stated;
}

void colorUnstated(Toolpath& toolpath) {
    const std::vector<double>& filament = toolpath.filament_by_tool;
    const auto changes = std::count_if(
        toolpath.color_changes.begin(), toolpath.color_changes.end(),
        [&](const ColorChange& change) { return !change.stated && change.first_bead < toolpath.beads.size(); });
    const auto tools = std::count_if(filament.begin(), filament.end(), [](double mm) { return mm > 0; });
    if (tools + changes < 2) return;
    if (toolpath.tool_colors.size() < filament.size()) toolpath.tool_colors.resize(filament.size());
    for (std::size_t tool = 0; tool < filament.size(); ++tool) {
        if (!(filament[tool] > 0) || toolpath.tool_colors[tool]) continue;
        toolpath.tool_colors[tool] = paletteColor(tool);
        toolpath.palette_tools.push_back(static_cast<std::uint8_t>(tool));
    }
    std::size_t next = filament.size();
    for (ColorChange& change : toolpath.color_changes)
        if (!change.stated) change.color = paletteColor(next++);
}

StatedColor statedColorOf(const Toolpath& toolpath, std::size_t bead) {
    const std::uint8_t tool = toolpath.runOf(toolpath.beads[bead]).tool;
    const auto begin = toolpath.color_changes.begin();
    for (auto change = changesUpTo(toolpath, bead); change != begin;)
        if ((--change)->tool == tool) return {change->color, tool, true, !change->stated};
    return colorOfTool(toolpath, tool);
}

std::vector<StatedColor> statedColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    std::vector<StatedColor> colors;
    std::set<std::optional<Rgb>> known;
    Sweep sweep(toolpath);
    for (const std::uint32_t bead : selection) {
        const StatedColor& stated = sweep.at(bead);
        if (!colors.empty() && colors.back().color == stated.color) continue;
        if (known.insert(stated.color).second) colors.push_back(stated);
    }
    return colors;
}

std::optional<Rgb> colorOf(const Toolpath& toolpath, std::size_t bead) { return statedColorOf(toolpath, bead).color; }

std::vector<std::optional<Rgb>> distinctColors(const Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    std::vector<std::optional<Rgb>> colors;
    for (const StatedColor& stated : statedColors(toolpath, selection)) colors.push_back(stated.color);
    return colors;
}

}  // namespace stratum::gcode
