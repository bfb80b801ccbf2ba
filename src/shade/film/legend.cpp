#include "shade/film/legend.h"

#include "shade/film/stroke_font.h"
#include "shade/film/tonemap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace stratum::shade {
namespace {

const Color kPanel(1.0f);
const Color kInk(0.13f);
const Color kEdge(0.55f);
constexpr float kPanelShare = 0.86f;

Color encoded(const Color& linear) { return {encodeSrgb(linear.r), encodeSrgb(linear.g), encodeSrgb(linear.b)}; }

/// All lengths in pixels, from the height of capitals.
struct Sizes {
    float capital, line, swatch, margin, ramp_width, ramp_height;

    explicit Sizes(int height)
        : capital(std::clamp(std::round(0.0145f * static_cast<float>(height)), 7.0f, 48.0f)),
          line(std::round(2.1f * capital)),
          swatch(std::round(1.25f * capital)),
          margin(std::round(1.2f * capital)),
          ramp_width(std::round(14.0f * capital)),
          ramp_height(std::round(1.3f * capital)) {}
};

void drawSwatch(Canvas& canvas, float x, float y, float width, float height, const std::vector<Color>& colors) {
    canvas.fill(x - 1.0f, y - 1.0f, x + width + 1.0f, y + height + 1.0f, kEdge);
    const auto columns = static_cast<int>(width);
    for (int n = 0; n < columns; ++n) {
        const std::size_t place = static_cast<std::size_t>(n) * colors.size() / static_cast<std::size_t>(columns);
        canvas.fill(x + static_cast<float>(n), y, x + static_cast<float>(n + 1), y + height, encoded(colors[place]));
    }
}

std::string titleOf(const Legend& legend) {
    return legend.unit.empty() ? legend.title : fmt::format("{} ({})", legend.title, legend.unit);
}

}  // namespace

void draw(const Legend& legend, int width, int height, std::vector<std::uint8_t>& rgb) {
    const Sizes s(height);
    Canvas canvas{width, height, rgb};
    const std::string title = titleOf(legend);
    const std::string least = fmt::format("{:.4g}", legend.least);
    const std::string most = fmt::format("{:.4g}", legend.most);
    // Number of lines below the title that fit into the picture; the last one states how many are left out.
    const auto room = static_cast<std::size_t>(
        std::max(1.0f, std::floor((static_cast<float>(height) - 4.0f * s.margin) / s.line) - 1));
    const bool cut = legend.entries.size() > room;
    const std::size_t shown = cut ? room - 1 : legend.entries.size();
    const std::string rest = cut ? fmt::format("and {} more", legend.entries.size() - shown) : std::string();
    const std::size_t lines = legend.ramp.empty() ? shown + (cut ? 1 : 0) : 2;
    float inner = std::max(textWidth(title, s.capital), textWidth(rest, s.capital));
    for (std::size_t n = 0; n < shown; ++n)
        inner = std::max(inner, 1.6f * s.swatch + textWidth(legend.entries[n].name, s.capital));
    if (!legend.ramp.empty())
        inner = std::max(inner, std::max(s.ramp_width, textWidth(least + "  " + most, s.capital)));

    const float left = s.margin;
    const float top = s.margin;
    const float panel_height = s.line * static_cast<float>(lines + 1) + 1.2f * s.margin;
    canvas.fill(left, top, left + inner + 2.0f * s.margin, top + panel_height, kPanel, kPanelShare);
    const float x = left + s.margin;
    float baseline = top + s.margin + s.capital;
    drawText(canvas, x, baseline, s.capital, title, kInk);
    if (!legend.ramp.empty()) {
        baseline += s.line;
        drawSwatch(canvas, x, baseline - s.capital, inner, s.ramp_height, legend.ramp);
        baseline += s.line;
        drawText(canvas, x, baseline, s.capital, least, kInk);
        drawText(canvas, x + inner - textWidth(most, s.capital), baseline, s.capital, most, kInk);
        return;
    }
    for (std::size_t n = 0; n < shown; ++n) {
        baseline += s.line;
        const float middle = baseline - 0.5f * s.capital;
        drawSwatch(canvas, x, std::round(middle - 0.5f * s.swatch), s.swatch, s.swatch, {legend.entries[n].color});
        drawText(canvas, x + 1.6f * s.swatch, baseline, s.capital, legend.entries[n].name, kInk);
    }
    if (cut) drawText(canvas, x, baseline + s.line, s.capital, rest, kInk);
}

}  // namespace stratum::shade
