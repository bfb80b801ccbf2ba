#include "shade/film/legend.h"

#include "shade/film/stroke_font.h"
#include "shade/film/tonemap.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace stratum::shade {
namespace {

const Color kPanel(1.0f);
const Color kInk(0.13f);
const Color kEdge(0.55f);
constexpr float kPanelShare = 0.86f;

Color encoded(const Color& linear) { return {encodeSrgb(linear.r), encodeSrgb(linear.g), encodeSrgb(linear.b)}; }

constexpr float kUsualLeast = 7.0f;  // pixels: smaller capitals, in narrower lines, where room is short

/// All lengths in pixels, from the height of capitals.
struct Sizes {
    float capital, line, swatch, margin, ramp_width, ramp_height;

    explicit Sizes(float of_capital)
        : capital(of_capital),
          line(std::round((capital < kUsualLeast ? 1.7f : 2.1f) * capital)),
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

/// What is written, and how much room it takes.
struct LegendLayout {
    Sizes sizes;
    std::string title, least, most;
    std::string rest;       // "and 3 more", if not all entries fit into the picture
    std::size_t shown = 0;  // entries
    float inner = 0.0f;     // width within the margins
    float width = 0.0f, height = 0.0f;

    LegendLayout(const Legend& legend, int picture_height, float capital)
        : sizes(capital),
          title(titleOf(legend)),
          least(fmt::format("{:.4g}", legend.least)),
          most(fmt::format("{:.4g}", legend.most)) {
        const Sizes& s = sizes;
        // Number of lines below the title that fit into the picture; the last one states how many are left out.
        const auto room = static_cast<std::size_t>(
            std::max(1.0f, std::floor((static_cast<float>(picture_height) - 4.0f * s.margin) / s.line) - 1));
        const bool cut = legend.entries.size() > room;
        shown = cut ? room - 1 : legend.entries.size();
        if (cut) rest = fmt::format("and {} more", legend.entries.size() - shown);
        const std::size_t lines = legend.ramp.empty() ? shown + (cut ? 1 : 0) : 2;
        inner = std::max(textWidth(title, capital), textWidth(rest, capital));
        for (std::size_t n = 0; n < shown; ++n)
            inner = std::max(inner, 1.6f * s.swatch + textWidth(legend.entries[n].name, capital));
        if (!legend.ramp.empty())
            inner = std::max(inner, std::max(s.ramp_width, textWidth(least + "  " + most, capital)));
        width = inner + 2.0f * s.margin;
        height = s.line * static_cast<float>(lines + 1) + 1.2f * s.margin;
    }
};

// Letters as large as the picture asks for, and smaller ones where the legend would hide too much of it.
LegendLayout legendLayoutOf(const Legend& legend, int width, int height) {
    constexpr float kMostShare = 1.0f / 8.0f;
    constexpr float kLeastCapital = 5.0f;  // can just be read
    const float room = kMostShare * static_cast<float>(width) * static_cast<float>(height);
    float capital = std::clamp(std::round(0.0145f * static_cast<float>(height)), kUsualLeast, 48.0f);
    while (true) {
        LegendLayout layout(legend, height, capital);
        if (layout.width * layout.height <= room || capital <= kLeastCapital) return layout;
        capital -= 1.0f;
    }
}

}  // namespace

void draw(const Legend& legend, int width, int height, std::vector<std::uint8_t>& rgb) {
    const LegendLayout layout = legendLayoutOf(legend, width, height);
    const Sizes& s = layout.sizes;
    const float inner = layout.inner;
    Canvas canvas{width, height, rgb};
    const float left = s.margin;
    const float top = s.margin;
    canvas.fill(left, top, left + layout.width, top + layout.height, kPanel, kPanelShare);
    const float x = left + s.margin;
    float baseline = top + s.margin + s.capital;
    drawText(canvas, x, baseline, s.capital, layout.title, kInk);
    if (!legend.ramp.empty()) {
        baseline += s.line;
        drawSwatch(canvas, x, baseline - s.capital, inner, s.ramp_height, legend.ramp);
        baseline += s.line;
        drawText(canvas, x, baseline, s.capital, layout.least, kInk);
        drawText(canvas, x + inner - textWidth(layout.most, s.capital), baseline, s.capital, layout.most, kInk);
        return;
    }
    for (std::size_t n = 0; n < layout.shown; ++n) {
        baseline += s.line;
        const float middle = baseline - 0.5f * s.capital;
        drawSwatch(canvas, x, std::round(middle - 0.5f * s.swatch), s.swatch, s.swatch, {legend.entries[n].color});
        drawText(canvas, x + 1.6f * s.swatch, baseline, s.capital, legend.entries[n].name, kInk);
    }
    if (!layout.rest.empty()) drawText(canvas, x, baseline + s.line, s.capital, layout.rest, kInk);
}

}  // namespace stratum::shade
