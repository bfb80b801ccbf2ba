#include "shade/denoise.h"

#include "io/error.h"
#include "parallel/parallel_for.h"
#include "shade/tile.h"

#include <glm/common.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string_view>

namespace stratum::shade {
namespace {

constexpr int kWindow = 8;      // pixels: how far neighbours may be
constexpr int kPatch = 2;       // pixels about each of the two that are compared
constexpr float kLight = 0.6f;  // how much larger than the noise a difference of light may be (Rousselle's k)
constexpr float kGuide = 0.7f;  // the distance in guides at which a neighbour counts 1/e

constexpr std::size_t kGuides = 7;               // normal 3, depth 1, albedo 3
constexpr std::size_t kTerms = 1 + kGuides + 2;  // a constant, the guides, the place
/// The ridge of the regression, relative to the sum of weights, in squared units of the guides: slopes along guides
/// that vary less than this are not to be trusted.
constexpr double kRidge = 1e-4;

/// What is known of a pixel.
struct Guided {
    Color color{0.0f};
    float luminance = 0.0f;
    float variance = 0.0f;  // of luminance
    std::array<float, kGuides> guides{};
};

/// All of a film, with guides in comparable units.
class Guides {
public:
    explicit Guides(const Film& film) : width_(film.width()), height_(film.height()), pixels_(film.pixels().size()) {
        const std::vector<float>& normal = layer(film, "normal");
        const std::vector<float>& depth = layer(film, "depth");
        const std::vector<float>& albedo = layer(film, "albedo");
        const std::vector<float>& variance = layer(film, "variance");
        for (std::size_t n = 0; n < pixels_.size(); ++n) {
            Guided& p = pixels_[n];
            p.color = film.pixels()[n].rgb;
            p.luminance = luminance(p.color);
            for (std::size_t c = 0; c < 3; ++c) {
                p.guides[c] = normal[3 * n + c];
                p.guides[4 + c] = albedo[3 * n + c];
            }
            // Depth counts by ratio, so that its unit doesn't matter: a hundredth of it is as much as one in a normal.
            p.guides[3] = 100.0f * std::log(std::max(depth[n], 1e-6f)) * (depth[n] > 0.0f ? 1.0f : 0.0f);
        }
        smoothGuides();
        // The variance of a few samples is itself noisy: a mean over 3 x 3 pixels.
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x) {
                double sum = 0.0;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) sum += static_cast<double>(variance[index(x + dx, y + dy)]);
                pixels_[index(x, y)].variance = static_cast<float>(sum / 9.0);
            }
    }
    /// Beyond the edges the picture is mirrored.
    const Guided& at(int x, int y) const { return pixels_[index(x, y)]; }

private:
    static const std::vector<float>& layer(const Film& film, std::string_view name) {
        for (const FilmLayer& l : film.layers())
            if (l.name == name) return l.values;
        throw std::invalid_argument("denoise() needs the layer " + std::string(name));
    }
    /// Guides are means over the same samples as the light and share their noise; a fit would keep what it explains.
    /// A binomial of 3 x 3 takes most of it and leaves layer lines of two pixels.
    void smoothGuides() {
        std::vector<std::array<float, kGuides>> smooth(pixels_.size());
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) {
                        const float weight = (dx == 0 ? 0.5f : 0.25f) * (dy == 0 ? 0.5f : 0.25f);
                        const Guided& q = pixels_[index(x + dx, y + dy)];
                        for (std::size_t k = 0; k < kGuides; ++k) smooth[index(x, y)][k] += weight * q.guides[k];
                    }
        for (std::size_t n = 0; n < pixels_.size(); ++n) pixels_[n].guides = smooth[n];
    }
    static int mirrored(int i, int count) {
        while (i < 0 || i >= count) i = i < 0 ? -1 - i : 2 * count - 1 - i;
        return i;
    }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(mirrored(y, height_)) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(mirrored(x, width_));
    }
    int width_, height_;
    std::vector<Guided> pixels_;
};

/// Difference of the light of two pixels beyond what their noise explains; about 0 for two of the same light.
float lightDistance(const Guided& p, const Guided& q) {
    const float d = p.luminance - q.luminance;
    const float noise = p.variance + std::min(p.variance, q.variance);
    return (d * d - noise) / (1e-10f + kLight * kLight * (p.variance + q.variance));
}

float guideDistance(const Guided& p, const Guided& q) {
    float sum = 0.0f;
    for (std::size_t k = 0; k < kGuides; ++k) {
        const float d = p.guides[k] - q.guides[k];
        sum += d * d;
    }
    return sum / (kGuide * kGuide);
}

/// The normal equations of one pixel's regression.
struct Regression {
    std::array<double, kTerms*(kTerms + 1) / 2> matrix{};  // lower triangle, row by row
    std::array<glm::dvec3, kTerms> right{};

    void add(float weight, const std::array<float, kTerms>& terms, const Color& color) {
        const glm::dvec3 c(color);
        std::size_t at = 0;
        for (std::size_t i = 0; i < kTerms; ++i) {
            const double wi = static_cast<double>(weight * terms[i]);
            for (std::size_t j = 0; j <= i; ++j) matrix[at++] += wi * static_cast<double>(terms[j]);
            right[i] += wi * c;
        }
    }

    /// The constant: the fitted value at the pixel itself. By Cholesky's factorization.
    glm::dvec3 value() const {
        std::array<std::array<double, kTerms>, kTerms> l{};
        std::array<glm::dvec3, kTerms> y{};
        // The constant goes last, so that it is the first to be known on the way back.
        const auto entry = [this](std::size_t i, std::size_t j) {
            const std::size_t a = kTerms - 1 - std::min(i, j);
            const std::size_t b = kTerms - 1 - std::max(i, j);
            const double ridge = i == j && a != 0 ? kRidge * matrix[0] : 0.0;
            return matrix[a * (a + 1) / 2 + b] + ridge;
        };
        for (std::size_t i = 0; i < kTerms; ++i) {
            glm::dvec3 rest = right[kTerms - 1 - i];
            for (std::size_t j = 0; j <= i; ++j) {
                double sum = entry(i, j);
                for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
                l[i][j] = i == j ? std::sqrt(std::max(sum, 1e-12 * matrix[0])) : sum / l[j][j];
            }
            for (std::size_t k = 0; k < i; ++k) rest -= l[i][k] * y[k];
            y[i] = rest / l[i][i];
        }
        return y.back() / l.back().back();
    }
};

void denoiseTile(const PixelBox& box, const Guides& in, std::vector<Color>& out, int film_width) {
    const int width = box.width();
    const int height = box.height();
    constexpr std::size_t kPatchWidth = 2 * std::size_t{kPatch} + 1;
    const auto row_width = static_cast<std::size_t>(width);
    const std::size_t columns = row_width + kPatchWidth - 1;
    const std::size_t lines = static_cast<std::size_t>(height) + kPatchWidth - 1;
    std::vector<Regression> sums(row_width * static_cast<std::size_t>(height));
    std::vector<float> distances(columns * lines);
    std::vector<float> rows(row_width * lines);
    for (int dy = -kWindow; dy <= kWindow; ++dy) {
        for (int dx = -kWindow; dx <= kWindow; ++dx) {
            // Distances of pixels, then of patches as sums along rows and columns.
            for (int y = -kPatch; y < height + kPatch; ++y)
                for (int x = -kPatch; x < width + kPatch; ++x)
                    distances[static_cast<std::size_t>(y + kPatch) * columns + static_cast<std::size_t>(x + kPatch)] =
                        lightDistance(in.at(box.x0 + x, box.y0 + y), in.at(box.x0 + x + dx, box.y0 + y + dy));
            for (std::size_t y = 0; y < lines; ++y)
                for (std::size_t x = 0; x < row_width; ++x) {
                    float sum = 0.0f;
                    for (std::size_t k = 0; k < kPatchWidth; ++k) sum += distances[y * columns + x + k];
                    rows[y * row_width + x] = sum;
                }
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    const std::size_t n = static_cast<std::size_t>(y) * row_width + static_cast<std::size_t>(x);
                    float light = 0.0f;
                    for (std::size_t k = 0; k < kPatchWidth; ++k) light += rows[n + k * row_width];
                    light /= static_cast<float>(kPatchWidth * kPatchWidth);
                    const Guided& p = in.at(box.x0 + x, box.y0 + y);
                    const Guided& q = in.at(box.x0 + x + dx, box.y0 + y + dy);
                    const float distance = std::max(light, 0.0f) + guideDistance(p, q);
                    if (!(distance < 8.0f)) continue;
                    std::array<float, kTerms> terms{1.0f};
                    for (std::size_t k = 0; k < kGuides; ++k) terms[1 + k] = q.guides[k] - p.guides[k];
                    terms[1 + kGuides] = static_cast<float>(dx) / kWindow;
                    terms[2 + kGuides] = static_cast<float>(dy) / kWindow;
                    sums[n].add(std::exp(-distance), terms, q.color);
                }
        }
    }
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const std::size_t n = static_cast<std::size_t>(y) * row_width + static_cast<std::size_t>(x);
            out[static_cast<std::size_t>(box.y0 + y) * static_cast<std::size_t>(film_width) +
                static_cast<std::size_t>(box.x0 + x)] = Color(glm::max(sums[n].value(), glm::dvec3(0.0)));
        }
}

}  // namespace

const char* const kDenoiserLabel = "first-order regression guided by normal, depth and albedo; biased";

void addDenoisingGuides(RenderOptions& options) {
    if (options.integrator.name != "path" && options.integrator.name != "direct")
        throw UsageError(
            fmt::format("--denoise: is for --integrator path and direct, not {}", options.integrator.name));
    for (const Aov guide : {Aov::normal, Aov::depth, Aov::albedo, Aov::variance})
        if (std::find(options.aovs.begin(), options.aovs.end(), guide) == options.aovs.end())
            options.aovs.push_back(guide);
}

void denoise(Film& film) {
    const Guides guides(film);
    std::vector<Color> clean(film.pixels().size());
    const std::vector<PixelBox> tiles = tilesOf({0, 0, film.width(), film.height()});
    parallelFor(tiles.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n) denoiseTile(tiles[n], guides, clean, film.width());
    });
    FilmLayer noisy{"noisy", {"R", "G", "B"}, {}};
    noisy.values.reserve(3 * clean.size());
    for (std::size_t n = 0; n < clean.size(); ++n) {
        Color& c = film.pixels()[n].rgb;
        noisy.values.insert(noisy.values.end(), {c.r, c.g, c.b});
        c = clean[n];
    }
    film.layers().push_back(std::move(noisy));
}

}  // namespace stratum::shade
