// Text as strokes of a pen, for what is written into pictures: a plain face of straight pieces, at any size.
#pragma once

#include "shade/color.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// An 8-bit RGB picture to draw into, row by row from the top. Coordinates are pixels from the upper left corner.
struct Canvas {
    int width = 0, height = 0;
    std::vector<std::uint8_t>& rgb;

    /// Mixes a colour (encoded, 0 to 1) into a pixel; outside the picture nothing happens.
    void mix(int x, int y, const Color& color, float share);
    /// An even rectangle with smooth edges.
    void fill(float x0, float y0, float x1, float y1, const Color& color, float share = 1.0f);
};

/// Width in pixels of a text whose capitals are this high. Characters beyond ASCII take the room of one '?' each.
float textWidth(std::string_view text, float capital_height);

/// Writes from x on, with capitals that stand on y = `baseline`. Characters beyond ASCII are written as '?'.
void drawText(Canvas& canvas, float x, float baseline, float capital_height, std::string_view text, const Color& color);

}  // namespace stratum::shade
