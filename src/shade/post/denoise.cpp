#include "shade/post/denoise.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "shade/post/denoise_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <mutex>
#include <stdexcept>
#include <string_view>

namespace stratum::shade {
namespace {

// The difference at which a neighbour counts 1/e.
constexpr float kNormal = 0.7f;
constexpr float kAlbedo = 0.3f;
constexpr float kDepth = 0.05f;  // of the logarithm: so that its unit doesn't matter

const std::vector<float>& layer(const Film& film, std::string_view name) {
    for (const FilmLayer& l : film.layers())
        if (l.name == name) return l.values;
    throw std::invalid_argument("denoise() needs the layer " + std::string(name));
}

/// Beyond the edges the picture is mirrored.
int mirrored(int i, int count) {
    while (i < 0 || i >= count) i = i < 0 ? -1 - i : 2 * count - 1 - i;
    return i;
}

DenoisePlanes planesOf(const Film& film) {
    const std::vector<float>& normal = layer(film, "normal");
    const std::vector<float>& depth = layer(film, "depth");
    const std::vector<float>& albedo = layer(film, "albedo");
    const std::vector<float>& shading = layer(film, "shading");
    const std::vector<float>& variance = layer(film, "variance");
    const auto index = [&film](int x, int y) {
        return static_cast<std::size_t>(mirrored(y, film.height())) * static_cast<std::size_t>(film.width()) +
               static_cast<std::size_t>(mirrored(x, film.width()));
    };
    const float bare = film.bareBed();
    DenoisePlanes planes(film.width(), film.height(), bare > 0.0f);
    const auto fill = [&](int x, int y) {
        const std::size_t n = index(x, y);
        const Color& color = film.pixels()[n].rgb;
        const float alpha = film.pixels()[n].alpha;
        *planes.at(DenoisePlanes::brightness, x, y) = luminance(color) + (1.0f - alpha) * bare;
        if (bare > 0.0f) *planes.at(DenoisePlanes::alpha, x, y) = alpha;
        // The variance of a few samples is itself noisy: a mean over 3 x 3 pixels.
        const int column = mirrored(x, film.width());
        const int row = mirrored(y, film.height());
        float sum = 0.0f;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) sum += variance[index(column + dx, row + dy)];
        *planes.at(DenoisePlanes::variance, x, y) = sum / 9.0f;
        const int guide = DenoisePlanes::closeness;
        for (int c = 0; c < 3; ++c) {
            const std::size_t k = 3 * n + static_cast<std::size_t>(c);
            *planes.at(DenoisePlanes::color + c, x, y) = color[c];
            *planes.at(guide + c, x, y) = normal[k] / kNormal;
            *planes.at(guide + 3 + c, x, y) = albedo[k] / kAlbedo;
        }
        *planes.at(guide + 6, x, y) = depth[n] > 0.0f ? std::log(depth[n]) / kDepth : 0.0f;
        *planes.at(DenoisePlanes::terms, x, y) = shading[2 * n];
        *planes.at(DenoisePlanes::terms + 1, x, y) = shading[2 * n + 1];
        // A scalar that differs for most pairs of colors.
        *planes.at(DenoisePlanes::terms + 2, x, y) =
            0.3f * albedo[3 * n] + 0.5f * albedo[3 * n + 1] + 0.2f * albedo[3 * n + 2];
    };
    constexpr int kMargin = DenoisePlanes::kMargin;
    parallelFor(static_cast<std::size_t>(planes.endY()) + kMargin, 16, [&](std::size_t first, std::size_t last) {
        for (std::size_t row = first; row != last; ++row)
            for (int x = -kMargin; x < planes.endX(); ++x) fill(x, static_cast<int>(row) - kMargin);
    });
    return planes;
}

}  // namespace

const char* const kDenoiserLabel = "first-order regression guided by normal, depth, albedo and bare light; biased";
const int kDenoisingMargin = Denoising::kRadius + Denoising::kPatch + 1;

bool canDenoise(const IntegratorOptions& integrator) {
    return integrator.name == "path" || integrator.name == "direct";
}

void addDenoisingGuides(RenderOptions& options) {
    if (!canDenoise(options.integrator))
        throw UsageError(
            fmt::format("--denoise: is for --integrator path and direct, not {}", options.integrator.name));
    if (options.spp < 2) throw UsageError("--denoise needs --spp 2 or more: one sample has no spread");
    for (const Aov guide : {Aov::normal, Aov::depth, Aov::albedo, Aov::shading, Aov::variance})
        if (std::find(options.aovs.begin(), options.aovs.end(), guide) == options.aovs.end())
            options.aovs.push_back(guide);
    options.margin = std::max(options.margin, kDenoisingMargin);
}

void denoise(Film& film, const Progress& progress) {
    const DenoisePlanes planes = planesOf(film);
    const std::size_t count = film.pixels().size();
    FilmLayer noisy{"noisy", {"R", "G", "B"}, {}};
    noisy.values.reserve(3 * count);
    for (const Pixel& p : film.pixels()) noisy.values.insert(noisy.values.end(), {p.rgb.r, p.rgb.g, p.rgb.b});

    const bool alpha = planes.channels() == 4;
    constexpr int kWidth = DenoisePlanes::kBlockWidth;
    constexpr int kHeight = DenoisePlanes::kBlockHeight;
    const int columns = (film.width() + kWidth - 1) / kWidth;
    const int rows = (film.height() + kHeight - 1) / kHeight;
    PerThread<DenoiseScratch> scratches;
    std::mutex mutex;
    std::uint64_t done = 0;
    parallelFor(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), 1,
                [&](std::size_t first, std::size_t last) {
                    DenoiseScratch& scratch = scratches.local();
                    for (std::size_t n = first; n != last; ++n) {
                        const int x0 = static_cast<int>(n) % columns * kWidth;
                        const int y0 = static_cast<int>(n) / columns * kHeight;
                        denoiseBlock(planes, x0, y0, scratch);
                        const int width = std::min(kWidth, film.width() - x0);
                        const int height = std::min(kHeight, film.height() - y0);
                        for (int y = 0; y < height; ++y)
                            for (int x = 0; x < width; ++x) {
                                const auto from = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
                                Pixel& pixel = film.at(film.region().x0 + x0 + x, film.region().y0 + y0 + y);
                                pixel.rgb = {scratch.colors[0][from], scratch.colors[1][from], scratch.colors[2][from]};
                                if (alpha) pixel.alpha = std::min(scratch.colors[3][from], 1.0f);
                                // Colors are premultiplied: where nothing is, neighbours must not leave any.
                                if (!(pixel.alpha > 0.0f)) pixel = {};
                            }
                        if (!progress) continue;
                        const std::lock_guard lock(mutex);
                        done += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
                        progress(done, count);
                    }
                });
    film.layers().push_back(std::move(noisy));
}

}  // namespace stratum::shade
