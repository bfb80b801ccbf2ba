#include "shade/finish/line_gloss.h"

#include "shade/finish/named_brdf.h"
#include "shade/palette/filament_color.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace stratum::shade {

Plastic plasticOfLines(const Color& body, float alpha, float ratio) {
    const float root = std::sqrt(ratio);
    return {body, Ggx(std::max(alpha / root, Plastic::kMinAlpha), std::min(alpha * root, 1.0f))};
}

std::string withGlossOfLines(std::string_view text) {
    if (text.empty()) {
        std::string_view same(kDefaultBrdf);
        same.remove_prefix(same.find(':'));
        return fmt::format("fdm{}", same);
    }
    const auto color = parseNamedColor(text);
    if (!color) return std::string(text);
    const Color body = bodyOf(*color);
    return fmt::format("fdm:{:.4g},{:.4g},{:.4g},{:g}", body.r, body.g, body.b, kFilamentAlpha);
}

bool hasGlossOfLines(std::string_view text) { return text.starts_with("fdm:"); }

}  // namespace stratum::shade
