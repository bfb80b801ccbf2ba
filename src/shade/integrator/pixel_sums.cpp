#include "shade/integrator/pixel_sums.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace stratum::shade {
namespace {

// The sums of a pixel, before those of its layers.
enum Sum : std::size_t { kRed, kGreen, kBlue, kAlpha, kLuminance, kSquare, kOwn };

}  // namespace

PixelSums::PixelSums(std::size_t pixels, std::vector<Aov> aovs)
    : aovs_(std::move(aovs)), pixels_(pixels), each_(kOwn + sumsOf(aovs_)), sums_(pixels * each_) {}

void PixelSums::add(std::size_t pixel, std::span<const Pixel> samples, const AovRecorder& recorder,
                    std::span<const SurfacePoint> points, std::span<const trace::Ray> rays) {
    const std::span<double> own = std::span(sums_).subspan(pixel * each_, each_);
    for (const Pixel& sample : samples) {
        // Of a transparent picture, that of the picture with a bed: the noise of shadows counts.
        const auto y = static_cast<double>(shade::luminance(sample.rgb) + (1.0f - sample.alpha) * recorder.bareBed());
        own[kRed] += static_cast<double>(sample.rgb.r);
        own[kGreen] += static_cast<double>(sample.rgb.g);
        own[kBlue] += static_cast<double>(sample.rgb.b);
        own[kAlpha] += static_cast<double>(sample.alpha);
        own[kLuminance] += y;
        own[kSquare] += y * y;
    }
    if (aovs_.empty()) return;
    for (std::size_t n = 0; n < samples.size(); ++n) recorder.add(points[n], rays[n].direction, own.subspan(kOwn));
}

double PixelSums::luminance(std::size_t pixel, int count) const { return sums_[pixel * each_ + kLuminance] / count; }

double PixelSums::variance(std::size_t pixel, int count) const {
    const double n = count;
    const double mean = luminance(pixel, count);
    return std::max(0.0, sums_[pixel * each_ + kSquare] / n - mean * mean) / std::max(n - 1.0, 1.0);
}

void PixelSums::store(std::size_t pixel, int count, Film& film, int x, int y) const {
    const std::span<const double> own = std::span(sums_).subspan(pixel * each_, each_);
    const auto mean = [&](std::size_t n) { return static_cast<float>(own[n] / count); };
    // Light that the print reflects onto the bed may exceed what it keeps from it; and where it keeps nearly all, the
    // few samples of a pixel may take more from the bed's known light than there is.
    Color color(mean(kRed), mean(kGreen), mean(kBlue));
    if (film.content() == FilmContent::radiance) color = glm::max(color, Color(0.0f));
    film.at(x, y) = {color, std::clamp(mean(kAlpha), 0.0f, 1.0f)};
    storeAovs(aovs_, own.subspan(kOwn), {variance(pixel, count), static_cast<std::uint32_t>(count)}, film.layers(),
              film.index(x, y));
}

}  // namespace stratum::shade
