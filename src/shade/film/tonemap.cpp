#include "shade/film/tonemap.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/srgb.h"
#include "shade/camera/sampler.h"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stratum::shade {
namespace {

/// A fixed number in [-0.5, 0.5) for a pixel and a channel.
float dither(int x, int y, std::uint32_t channel) {
    const std::uint32_t key =
        sobol::hash(static_cast<std::uint32_t>(x) ^ (channel << 30), static_cast<std::uint32_t>(y));
    return sobol::toFloat(key) - 0.5f;
}

/// @param noise  in steps of the 8 bits
std::uint8_t toByte(float encoded, float noise) {
    const float v = std::isfinite(encoded) ? encoded : 0.0f;
    return static_cast<std::uint8_t>(std::clamp(v * 255.0f + noise + 0.5f, 0.0f, 255.0f));
}

struct DepthRange {
    float near = std::numeric_limits<float>::infinity();
    float far = 0.0f;
};
DepthRange depthRange(const Film& film) {
    DepthRange range;
    for (const Pixel& p : film.pixels()) {
        if (!(p.alpha > 0.5f)) continue;
        range.near = std::min(range.near, p.rgb.r / p.alpha);
        range.far = std::max(range.far, p.rgb.r / p.alpha);
    }
    return range;
}

struct PositionRange {
    Color low{std::numeric_limits<float>::infinity()};
    Color high{-std::numeric_limits<float>::infinity()};
};
PositionRange positionRange(const Film& film) {
    PositionRange range;
    for (const Pixel& p : film.pixels()) {
        if (!(p.alpha > 0.5f)) continue;
        range.low = glm::min(range.low, p.rgb / p.alpha);
        range.high = glm::max(range.high, p.rgb / p.alpha);
    }
    return range;
}

Color encoded(const Color& c) { return {encodeSrgb(c.r), encodeSrgb(c.g), encodeSrgb(c.b)}; }

/// From the means of a film to what a screen shows, in [0, 1].
class Display {
public:
    Display(const Film& film, const ToneOptions& options)
        : content_(film.content()), scale_(static_cast<float>(std::exp2(options.exposure))) {
        if (content_ == FilmContent::depth) depths_ = depthRange(film);
        if (content_ == FilmContent::position) box_ = positionRange(film);
    }

    /// Whether eight bits are too few for smooth gradients.
    bool dithers() const { return content_ == FilmContent::radiance || content_ == FilmContent::unit; }

    /// What the display shines with, of a pixel of light.
    Color light(const Color& rgb) const {
        return content_ == FilmContent::radiance ? toneMapNeutral(glm::max(rgb * scale_, Color(0.0f))) : rgb;
    }

    Color color(const Pixel& pixel) const {
        switch (content_) {
            case FilmContent::radiance:
            case FilmContent::unit:
                return encoded(light(pixel.rgb));
            case FilmContent::normal:
                return 0.5f * (pixel.rgb + Color(1.0f));
            case FilmContent::position:
                return place(pixel);
            case FilmContent::depth:
                return Color(nearness(pixel));
        }
        return pixel.rgb;
    }

private:
    Color place(const Pixel& pixel) const {
        Color c = pixel.rgb;
        for (int k = 0; k < 3 && pixel.alpha > 0.0f; ++k) {
            const float span = std::max(box_.high[k] - box_.low[k], std::numeric_limits<float>::min());
            c[k] = pixel.alpha * std::clamp((c[k] / pixel.alpha - box_.low[k]) / span, 0.0f, 1.0f);
        }
        return c;
    }
    float nearness(const Pixel& pixel) const {
        // 0.1 is the farthest surface; black is left for "nothing".
        const float span = std::max(depths_.far - depths_.near, std::numeric_limits<float>::min());
        const float share = pixel.alpha > 0.0f ? (pixel.rgb.r / pixel.alpha - depths_.near) / span : 0.0f;
        return pixel.alpha * (1.0f - 0.9f * std::clamp(share, 0.0f, 1.0f));
    }

    FilmContent content_;
    float scale_;
    DepthRange depths_;
    PositionRange box_;
};

/// A partly transparent pixel, of which `color` is what there is, before encoding. Programs lay pictures over others by
/// their encoded values: value = S A + (1 - A) b. Light from it over a backdrop of the value b has the value
///     v(b) = encode(alpha color + (1 - alpha) decode(b)),
/// which is no line. S and A are those of the line of least squares, with one A for the three channels. For a shadow,
/// which is black, v is nearly one, since encode() is nearly a power.
std::array<std::uint8_t, 4> straightPixel(const Color& color, float alpha) {
    constexpr std::array<float, 5> kBackdrops = {0.0f, 0.25f, 0.5f, 0.75f, 1.0f};
    constexpr std::array<float, 5> kLight = {0.0f, 0.0508761f, 0.214041f, 0.522522f, 1.0f};  // decoded
    constexpr float kMean = 0.5f;
    constexpr float kSquares = 0.625f;  // sum of (b - kMean)^2
    Color slope(0.0f);
    Color mean(0.0f);
    for (std::size_t n = 0; n < kLight.size(); ++n) {
        const Color value = encoded(alpha * color + Color((1.0f - alpha) * kLight[n]));
        slope += (kBackdrops[n] - kMean) / kSquares * value;
        mean += value / static_cast<float>(kLight.size());
    }
    const std::uint8_t opaque = toByte(1.0f - (slope.r + slope.g + slope.b) / 3.0f, 0.0f);
    std::array<std::uint8_t, 4> bytes{0, 0, 0, opaque};
    if (opaque == 0) return bytes;
    const float share = static_cast<float>(opaque) / 255.0f;
    for (int c = 0; c < 3; ++c)
        bytes[static_cast<std::size_t>(c)] = toByte((mean[c] - (1.0f - share) * kMean) / share, 0.0f);
    return bytes;
}

}  // namespace

void ToneOptions::validate() const {
    if (!(exposure >= -30.0 && exposure <= 30.0))
        throw UsageError(fmt::format("--exposure {}: must be from -30 to 30 stops", exposure));
}

Color toneMapNeutral(Color color) {
    constexpr float kStart = 0.8f - 0.04f;
    constexpr float kDesaturation = 0.15f;
    // Subtracts the 4 % Fresnel reflection of the surroundings from a base color.
    const float low = std::min({color.r, color.g, color.b});
    color -= low < 0.08f ? low - 6.25f * low * low : 0.04f;
    const float peak = maxComponent(color);
    if (peak < kStart) return color;
    constexpr float kRoom = 1.0f - kStart;
    const float new_peak = 1.0f - kRoom * kRoom / (peak + kRoom - kStart);
    color *= new_peak / peak;
    const float white = 1.0f - 1.0f / (kDesaturation * (peak - new_peak) + 1.0f);
    return (1.0f - white) * color + white * Color(new_peak);
}

float encodeSrgb(float linear) {
    if (!(linear > 0.0f)) return 0.0f;
    return srgbOfLinear(linear);
}

std::vector<std::uint8_t> toDisplay(const Film& film, const ToneOptions& options) {
    options.validate();
    const Display display(film, options);
    const PixelBox& region = film.region();
    const auto width = static_cast<std::size_t>(region.width());
    std::vector<std::uint8_t> bytes(film.pixels().size() * 3);
    constexpr std::size_t kRows = 16;
    parallelFor(static_cast<std::size_t>(region.height()), kRows, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row != last; ++row) {
            const int y = region.y0 + static_cast<int>(row);
            std::uint8_t* out = bytes.data() + row * width * 3;
            for (int x = region.x0; x < region.x1; ++x) {
                const Color c = display.color(film.at(x, y));
                for (std::uint32_t channel = 0; channel < 3; ++channel)
                    *out++ = toByte(c[static_cast<int>(channel)], display.dithers() ? dither(x, y, channel) : 0.0f);
            }
        }
    });
    return bytes;
}

std::vector<std::uint8_t> toDisplayWithAlpha(const Film& film, const ToneOptions& options) {
    Film straight(film.frameWidth(), film.frameHeight(), film.region(), film.content());
    for (std::size_t n = 0; n < film.pixels().size(); ++n) {
        const Pixel& pixel = film.pixels()[n];
        if (pixel.alpha > 0.0f) straight.pixels()[n] = {pixel.rgb / pixel.alpha, 1.0f};
    }
    const std::vector<std::uint8_t> rgb = toDisplay(straight, options);
    const Display display(straight, options);
    const bool radiance = film.content() == FilmContent::radiance;  // the alpha of others is the share of a pixel
    std::vector<std::uint8_t> rgba;
    rgba.reserve(4 * film.pixels().size());
    for (std::size_t n = 0; n < film.pixels().size(); ++n) {
        const float alpha = film.pixels()[n].alpha;
        if (radiance && alpha > 0.0f && alpha < 1.0f) {
            const std::array<std::uint8_t, 4> pixel = straightPixel(display.light(straight.pixels()[n].rgb), alpha);
            rgba.insert(rgba.end(), pixel.begin(), pixel.end());
            continue;
        }
        const std::uint8_t byte = toByte(alpha, 0.0f);
        for (std::size_t c = 0; c < 3; ++c) rgba.push_back(byte > 0 ? rgb[3 * n + c] : std::uint8_t{0});
        rgba.push_back(byte);
    }
    return rgba;
}

std::vector<std::uint8_t> overBlack(const std::vector<std::uint8_t>& rgba) {
    std::vector<std::uint8_t> rgb;
    rgb.reserve(rgba.size() / 4 * 3);
    for (std::size_t n = 0; n + 3 < rgba.size(); n += 4)
        for (std::size_t c = 0; c < 3; ++c)
            rgb.push_back(static_cast<std::uint8_t>((rgba[n + c] * rgba[n + 3] + 127) / 255));
    return rgb;
}

}  // namespace stratum::shade
