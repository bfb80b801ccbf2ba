#include "assemble/print/tool_colors.h"

#include "base/error.h"
#include "base/text.h"
#include "shade/palette/color_name.h"

#include <fmt/format.h>

#include <cstdint>

namespace stratum::assemble {

ToolColors toolColorsOf(std::string_view list, std::string_view option) {
    constexpr std::size_t kMostTools = 256;
    ToolColors result;
    for (const std::string_view piece : split(list)) {
        const std::string_view name = trim(piece);
        if (result.colors.size() == kMostTools)
            throw UsageError(fmt::format("{}: more than {} colours; there are no more tools", option, kMostTools));
        if (name.empty()) {
            result.colors.emplace_back();
            continue;
        }
        const shade::ColorName color = shade::colorNamed(name, option);
        result.colors.push_back(gcode::Rgb{static_cast<std::uint8_t>(color.color >> 16),
                                           static_cast<std::uint8_t>(color.color >> 8 & 0xff),
                                           static_cast<std::uint8_t>(color.color & 0xff)});
        if (color.brdf.find(':') != std::string::npos)
            result.finishes.emplace(fmt::format("#{:06x}", color.color), color.brdf);
    }
    return result;
}

}  // namespace stratum::assemble
