// How far pictures are from a reference: the figures of docs/benchmarks.md, "Pictures".
#include "shade/film/exr.h"
#include "shade/film/film.h"
#include "study/picture/flip.h"
#include "study/picture/image_error.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using stratum::shade::Color;
using stratum::shade::ExrImage;

constexpr std::size_t kMostPixels = std::size_t{1} << 28;

struct Error {
    double rel_mse = 0.0;   // mean of (x - r)^2 / (r^2 + 0.01) over pixels and channels
    double rmse = 0.0;      // root mean square of x - r
    double bias = 0.0;      // (sum x - sum r) / sum r
    double relative = 0.0;  // sum |x - r| / sum r
    double worst = 0.0;     // 99.9th percentile over pixels of |x - r| / sqrt(r^2 + 0.01), its largest channel
};

Error compare(const ExrImage& reference, const ExrImage& picture) {
    Error e;
    double sum = 0.0;
    double difference = 0.0;
    std::vector<double> pixels;
    pixels.reserve(reference.rgb.size());
    for (std::size_t n = 0; n < reference.rgb.size(); ++n) {
        double largest = 0.0;
        for (int c = 0; c < 3; ++c) {
            const auto r = static_cast<double>(reference.rgb[n][c]);
            const double d = static_cast<double>(picture.rgb[n][c]) - r;
            const double relative = d * d / (r * r + 0.01);
            e.rel_mse += relative;
            e.rmse += d * d;
            difference += d;
            e.relative += std::abs(d);
            sum += r;
            largest = std::max(largest, std::sqrt(relative));
        }
        pixels.push_back(largest);
    }
    const double values = 3.0 * static_cast<double>(pixels.size());
    e.rel_mse /= values;
    e.rmse = std::sqrt(e.rmse / values);
    e.bias = difference / sum;
    e.relative /= sum;
    const auto place = static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(pixels.size() - 1));
    std::nth_element(pixels.begin(), pixels.begin() + place, pixels.end());
    e.worst = pixels[static_cast<std::size_t>(place)];
    return e;
}

// As a PNG shows it, at the studio's exposure.
stratum::study::DisplayPicture shown(const ExrImage& image) {
    stratum::shade::Film film(image.width, image.height, {0, 0, image.width, image.height});
    for (std::size_t n = 0; n < image.rgb.size(); ++n) film.pixels()[n].rgb = image.rgb[n];
    return stratum::study::displayed(film);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Compares pictures with a reference. EXR, linear.");
    std::string reference;
    std::vector<std::string> pictures;
    app.add_option("REFERENCE", reference)->required();
    app.add_option("PICTURE", pictures)->required();
    CLI11_PARSE(app, argc, argv);
    try {
        const ExrImage truth = stratum::shade::readExr(reference, kMostPixels);
        fmt::print("{:>11} {:>11} {:>10} {:>10} {:>10} {:>8}  picture\n", "relMSE", "RMSE", "bias", "mean |d|",
                   "99.9 %", "FLIP");
        const auto truth_shown = shown(truth);
        for (const std::string& name : pictures) {
            const ExrImage picture = stratum::shade::readExr(name, kMostPixels);
            if (picture.width != truth.width || picture.height != truth.height) {
                fmt::print(stderr, "{}: has another size than {}\n", name, reference);
                return 3;
            }
            const Error e = compare(truth, picture);
            fmt::print("{:11.3e} {:11.3e} {:+10.5f} {:10.5f} {:10.4f} {:8.4f}  {}\n", e.rel_mse, e.rmse, e.bias,
                       e.relative, e.worst, stratum::study::meanFlip(truth_shown, shown(picture)), name);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 3;
    }
    return 0;
}
