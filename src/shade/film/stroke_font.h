// A stroke font of line segments, scalable, for text in pictures.
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

    /// Blends a color (encoded, 0 to 1) into a pixel; does nothing outside the picture.
    void mix(int x, int y, const Color& color, float share);
    /// A filled rectangle with antialiased edges.
    void fill(float x0, float y0, float x1, float y1, const Color& color, float share = 1.0f);
};

/// Width in pixels of a text whose capitals are this high. Non-ASCII characters count as one '?' each.
float textWidth(std::string_view text, float capital_height);

/// Writes from x on, with the baseline at y = `baseline`. Non-ASCII characters are written as '?'.
void drawText(Canvas& canvas, float x, float baseline, float capital_height, std::string_view text, const Color& color);

}  // namespace stratum::shade
