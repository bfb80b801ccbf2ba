#include "gcode/printer/mixer.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <span>
#include <string_view>

namespace stratum::gcode {
namespace {

constexpr double kMostTools = 255;

std::optional<ToolMix> mixOf(std::size_t tool, std::span<const double> factors) {
    const double sum = std::accumulate(factors.begin(), factors.end(), 0.0);
    if (!(sum > 0) || !std::isfinite(sum) || tool >= static_cast<std::size_t>(kMostTools)) return std::nullopt;
    ToolMix mix{static_cast<std::uint8_t>(tool), std::vector<double>(factors.begin(), factors.end())};
    while (!(mix.shares.back() > 0)) mix.shares.pop_back();
    for (double& share : mix.shares) share /= sum;
    return mix;
}

std::size_t toolOf(const Command& command, char letter, std::size_t current_tool) {
    if (!command.hasValue(letter)) return current_tool;
    const double tool = command.value(letter);
    return tool >= 0 && tool < kMostTools ? static_cast<std::size_t>(tool) : static_cast<std::size_t>(kMostTools);
}

}  // namespace

bool Mixer::setFactor(const Command& command) {
    const double filament = command.hasValue('S') ? command.value('S') : 0;
    if (!(filament >= 0 && filament < static_cast<double>(kFilaments))) return false;
    const double factor = command.hasValue('P') ? command.value('P') : 0;
    factors_[static_cast<std::size_t>(filament)] = factor > 0 ? factor : 0;
    return true;
}

std::optional<ToolMix> Mixer::save(const Command& command, std::size_t current_tool) const {
    return mixOf(toolOf(command, 'S', current_tool), factors_);
}

std::optional<ToolMix> Mixer::setAll(const Command& command, std::size_t current_tool) {
    constexpr std::string_view kLetters = "ABCDHI";
    factors_.fill(0);
    for (std::size_t n = 0; n < kLetters.size(); ++n)
        if (command.hasValue(kLetters[n])) factors_[n] = std::max(command.value(kLetters[n]), 0.0);
    return mixOf(current_tool, factors_);
}

std::optional<ToolMix> Mixer::ofTool(const Command& command, std::size_t current_tool) {
    const std::size_t list = command.text.find_first_of("Ee");
    if (list == std::string_view::npos) return std::nullopt;
    std::string_view rest = command.text.substr(list + 1);
    std::vector<double> factors;
    while (factors.size() < kFilaments) {
        double factor = 0;
        const auto [end, error] =
            std::from_chars(rest.data(), rest.data() + rest.size(), factor, std::chars_format::fixed);
        if (error != std::errc{}) return std::nullopt;
        factors.push_back(std::max(factor, 0.0));
        rest.remove_prefix(static_cast<std::size_t>(end - rest.data()));
        if (!rest.starts_with(':')) break;
        rest.remove_prefix(1);
    }
    return mixOf(toolOf(command, 'P', current_tool), factors);
}

}  // namespace stratum::gcode
