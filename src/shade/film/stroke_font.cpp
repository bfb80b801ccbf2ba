#include "shade/film/stroke_font.h"

#include "base/text.h"

#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::shade {
namespace {

// Strokes of each character from '!' to '~', points as a digit for x (0 to 4) and a letter for y (a is 2 below the
// baseline c, g the height of small letters, i that of capitals). A space lifts the pen.
constexpr std::string_view kStrokes =
    "2i2e 2c2c|1i1h 3i3h|1c1i 3c3i 0e4e 0g4g|4h3i1i0h0g1f3f4e4d3c1c0d 2i2c|0c4i 0h0i1i1h0h 3c3d4d4c3c|"
    "4c1h1i2i2h0e0d1c2c4e|2i2h|3i2h2b3a|1i2h2b1a|0g4e 0e4g 2h2d|0e4e 2g2c|2c1b|1e3e|2c2c|0b4i|1i2i3h3d2c1c0d0h1i|"
    "1h2i2c 1c3c|0h1i3i4h4g0c4c|0h1i3i4h4g3f4e4d3c1c0d 2f3f|3c3i0e4e|4i0i0f3f4e4d3c1c0d|4h3i1i0h0d1c3c4d4e3f1f0e|"
    "0i4i1c|1f0g0h1i3i4h4g3f1f0e0d1c3c4d4e3f|0d1c3c4d4h3i1i0h0g1f3f4g|2c2c 2f2f|2f2f 2c1b|4g0e4c|0d4d 0f4f|0g4e0c|"
    "0h1i3i4h4g2f2e 2c2c|4d3c1c0d0h1i3i4h4e2e2g4g|0c2i4c 1e3e|0c0i3i4h4g3f0f 3f4e4d3c0c|4h3i1i0h0d1c3c4d|"
    "0c0i2i4g4e2c0c|4i0i0c4c 0f3f|4i0i0c 0f3f|4h3i1i0h0d1c3c4d4f2f|0i0c 4i4c 0f4f|2i2c 1i3i 1c3c|4i4d3c1c0d|"
    "0i0c 4i0e 1f4c|0i0c4c|0c0i2f4i4c|0c0i4c4i|1i3i4h4d3c1c0d0h1i|0c0i3i4h4g3f0f|1i3i4h4d3c1c0d0h1i 2e4c|"
    "0c0i3i4h4g3f0f 2f4c|4h3i1i0h0g1f3f4e4d3c1c0d|0i4i 2i2c|0i0d1c3c4d4i|0i2c4i|0i1c2g3c4i|0i4c 0c4i|0i2f4i 2f2c|"
    "0i4i0c4c|3i2i2a3a|0i4b|1i2i2a1a|0g2i4g|0b4b|1i2h|4g4c 4f3g1g0f0d1c3c4d|0i0c 0f1g3g4f4d3c1c0d|4f3g1g0f0d1c3c4d|"
    "4i4c 4f3g1g0f0d1c3c4d|0e4e4f3g1g0f0d1c3c4d|3i2i1h1c 0g3g|4g4b3a1a0b 4f3g1g0f0d1c3c4d|0i0c 0f1g3g4f4c|2g2c 2i2i|"
    "2g2b1a0a 2i2i|0i0c 4g0d 1e4c|2i2d3c|0g0c 0f1g2f2c 2f3g4f4c|0g0c 0f1g3g4f4c|1g3g4f4d3c1c0d0f1g|"
    "0g0a 0f1g3g4f4d3c1c0d|4g4a 4f3g1g0f0d1c3c4d|0g0c 0f1g3g|4f3g1g0f1e3e4d3c1c0d|1i1d2c3c 0g3g|0g0d1c3c4d 4g4c|"
    "0g2c4g|0g1c2f3c4g|0g4c 0c4g|0g2c 4g1a|0g4g0c4c|3i2h2g1f2e2b3a|2i2a|1i2h2g3f2e2b1a|0f1g3e4f";

std::string_view strokesOf(std::size_t character) {
    static const std::vector<std::string_view> strokes = split(kStrokes, '|');
    return strokes[character];
}

constexpr float kUnits = 6.0f;  // of a capital's height
constexpr float kGap = 1.9f;    // from one character to the next
constexpr float kSpace = 2.6f;  // of ' '
constexpr float kPen = 0.95f;   // the pen's width
constexpr float kNoPoint = -1.0f;

/// Calls f for each character's strokes, once a character; UTF-8's later bytes belong to the one before.
template <typename F>
void eachCharacter(std::string_view text, const F& f) {
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xc0U) == 0x80U) continue;
        if (byte == ' ')
            f(std::string_view());
        else
            f(strokesOf(byte > ' ' && byte < 0x7f ? byte - std::size_t{'!'} : std::size_t{'?' - '!'}));
    }
}

// The narrowest box in x, in units.
std::pair<float, float> sidesOf(std::string_view strokes) {
    float left = 4.0f;
    float right = 0.0f;
    for (const char c : strokes) {
        if (c < '0' || c > '4') continue;
        left = std::min(left, static_cast<float>(c - '0'));
        right = std::max(right, static_cast<float>(c - '0'));
    }
    return {left, right};
}

float advanceOf(std::string_view strokes) {
    if (strokes.empty()) return kSpace;
    const auto [left, right] = sidesOf(strokes);
    return right - left + kGap;
}

float distanceTo(const glm::vec2& p, const glm::vec2& a, const glm::vec2& b) {
    const glm::vec2 line = b - a;
    const float square = glm::dot(line, line);
    const float t = square > 0.0f ? std::clamp(glm::dot(p - a, line) / square, 0.0f, 1.0f) : 0.0f;
    return glm::length(p - a - t * line);
}

/// The lines of a character; a lifted pen is a NaN.
std::vector<glm::vec2> pointsOf(std::string_view strokes, float x, float baseline, float unit) {
    std::vector<glm::vec2> points;
    const float left = sidesOf(strokes).first;
    for (std::size_t n = 0; n < strokes.size(); ++n) {
        if (strokes[n] == ' ') {
            points.emplace_back(kNoPoint, std::numeric_limits<float>::quiet_NaN());
            continue;
        }
        const auto column = static_cast<float>(strokes[n] - '0');
        const auto row = static_cast<float>(strokes[++n] - 'c');
        points.emplace_back(x + (column - left) * unit, baseline - row * unit);
    }
    return points;
}

}  // namespace

void Canvas::mix(int x, int y, const Color& color, float share) {
    if (x < 0 || y < 0 || x >= width || y >= height || !(share > 0.0f)) return;
    const std::size_t first =
        3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    for (int c = 0; c < 3; ++c) {
        std::uint8_t& byte = rgb[first + static_cast<std::size_t>(c)];
        const float mixed = (1.0f - share) * static_cast<float>(byte) + share * 255.0f * color[c];
        byte = static_cast<std::uint8_t>(std::clamp(mixed + 0.5f, 0.0f, 255.0f));
    }
}

void Canvas::fill(float x0, float y0, float x1, float y1, const Color& color, float share) {
    const auto overlap = [](float from, float to, int pixel) {
        return std::clamp(std::min(to, static_cast<float>(pixel + 1)) - std::max(from, static_cast<float>(pixel)), 0.0f,
                          1.0f);
    };
    for (int y = static_cast<int>(std::floor(y0)); static_cast<float>(y) < y1; ++y)
        for (int x = static_cast<int>(std::floor(x0)); static_cast<float>(x) < x1; ++x)
            mix(x, y, color, share * overlap(x0, x1, x) * overlap(y0, y1, y));
}

float textWidth(std::string_view text, float capital_height) {
    float units = 0.0f;
    eachCharacter(text, [&](std::string_view strokes) { units += advanceOf(strokes); });
    return std::max(units - kGap + kPen, 0.0f) * capital_height / kUnits;
}

void drawText(Canvas& canvas, float x, float baseline, float capital_height, std::string_view text,
              const Color& color) {
    const float unit = capital_height / kUnits;
    const float pen = std::max(kPen * unit, 1.0f);
    x += 0.5f * pen;
    eachCharacter(text, [&](std::string_view strokes) {
        const std::vector<glm::vec2> points = pointsOf(strokes, x, baseline, unit);
        x += advanceOf(strokes) * unit;
        glm::vec2 low(std::numeric_limits<float>::max());
        glm::vec2 high(-std::numeric_limits<float>::max());
        for (const glm::vec2& p : points) {
            if (std::isnan(p.y)) continue;
            low = {std::min(low.x, p.x), std::min(low.y, p.y)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y)};
        }
        if (low.x > high.x) return;  // a blank
        for (int py = static_cast<int>(std::floor(low.y - pen)); static_cast<float>(py) <= high.y + pen; ++py)
            for (int px = static_cast<int>(std::floor(low.x - pen)); static_cast<float>(px) <= high.x + pen; ++px) {
                const glm::vec2 p(static_cast<float>(px) + 0.5f, static_cast<float>(py) + 0.5f);
                float nearest = std::numeric_limits<float>::max();
                for (std::size_t n = 0; n + 1 < points.size(); ++n)
                    if (!std::isnan(points[n].y) && !std::isnan(points[n + 1].y))
                        nearest = std::min(nearest, distanceTo(p, points[n], points[n + 1]));
                canvas.mix(px, py, color, std::clamp(0.5f + 0.5f * pen - nearest, 0.0f, 1.0f));
            }
    });
}

}  // namespace stratum::shade
