// The estimator of denoise() written down plainly: in double, one pixel after the other, nothing shared between them.
#pragma once

#include "shade/film/film.h"
#include "shade/post/denoise_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

namespace stratum::test {

class DenoiseOracle {
public:
    explicit DenoiseOracle(const shade::Film& film) : film_(film) {}

    /// @param x, y  from the film's upper left corner
    std::array<double, 3> pixel(int x, int y) const {
        constexpr int r = shade::Denoising::kRadius;
        std::array<std::array<double, kUnknowns + 3>, kUnknowns> system{};
        for (int dy = -r; dy <= r; ++dy)
            for (int dx = -r; dx <= r; ++dx) {
                if (dx * dx + dy * dy > r * (r + 1)) continue;
                const double w = std::pow(std::max(0.0, 1.0 - distance(x, y, x + dx, y + dy) / 8.0), 8);
                std::array<double, kUnknowns> t{double(dx) / r, double(dy) / r, 0, 0, 0, 1};
                for (int k = 0; k < 3; ++k) t[std::size_t(2 + k)] = term(k, x + dx, y + dy) - term(k, x, y);
                for (std::size_t i = 0; i < kUnknowns; ++i) {
                    for (std::size_t j = 0; j < kUnknowns; ++j) system[i][j] += w * t[i] * t[j];
                    for (int c = 0; c < 3; ++c)
                        system[i][kUnknowns + std::size_t(c)] += w * t[i] * double(color(x + dx, y + dy)[c]);
                }
            }
        const double ridge = double(shade::Denoising::kRidge) * system[kUnknowns - 1][kUnknowns - 1];
        for (std::size_t i = 0; i + 1 < kUnknowns; ++i) system[i][i] += ridge;
        // Gauss and Jordan; the matrix is positive definite.
        for (std::size_t i = 0; i < kUnknowns; ++i)
            for (std::size_t row = 0; row < kUnknowns; ++row) {
                if (row == i) continue;
                const double factor = system[row][i] / system[i][i];
                for (std::size_t k = i; k < kUnknowns + 3; ++k) system[row][k] -= factor * system[i][k];
            }
        std::array<double, 3> value{};
        for (std::size_t c = 0; c < 3; ++c)
            value[c] = std::max(least(x, y, int(c)),
                                system[kUnknowns - 1][kUnknowns + c] / system[kUnknowns - 1][kUnknowns - 1]);
        return value;
    }

private:
    static constexpr std::size_t kUnknowns = 6;

    static int mirrored(int i, int count) {
        while (i < 0 || i >= count) i = i < 0 ? -1 - i : 2 * count - 1 - i;
        return i;
    }
    std::size_t index(int x, int y) const {
        return std::size_t(mirrored(y, film_.height())) * std::size_t(film_.width()) +
               std::size_t(mirrored(x, film_.width()));
    }
    double layer(std::string_view name, int x, int y, std::size_t channel) const {
        for (const shade::FilmLayer& l : film_.layers())
            if (l.name == name) return double(l.values[index(x, y) * l.channels.size() + channel]);
        return std::nan("");
    }
    const shade::Color& color(int x, int y) const { return film_.pixels()[index(x, y)].rgb; }
    /// Of the 3 x 3 pixels around.
    double least(int x, int y, int c) const {
        float found = color(x, y)[c];
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) found = std::min(found, color(x + dx, y + dy)[c]);
        return double(found);
    }
    double variance(int x, int y) const {
        double sum = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                // The mean is taken of the film, and then mirrored.
                const std::size_t n = index(x, y);
                const auto width = std::size_t(film_.width());
                sum += layer("variance", int(n % width) + dx, int(n / width) + dy, 0);
            }
        return sum / 9;
    }
    double term(int k, int x, int y) const {
        if (k < 2) return layer("shading", x, y, std::size_t(k));
        return 0.3 * layer("albedo", x, y, 0) + 0.5 * layer("albedo", x, y, 1) + 0.2 * layer("albedo", x, y, 2);
    }
    double distance(int px, int py, int qx, int qy) const {
        double light = 0;
        constexpr int kPatch = shade::Denoising::kPatch;
        for (int dy = -kPatch; dy <= kPatch; ++dy)
            for (int dx = -kPatch; dx <= kPatch; ++dx) {
                const double a = variance(px + dx, py + dy);
                const double b = variance(qx + dx, qy + dy);
                const double d = double(shade::luminance(color(px + dx, py + dy))) -
                                 double(shade::luminance(color(qx + dx, qy + dy)));
                light += (d * d - (a + std::min(a, b))) / (1e-10 + 0.36 * (a + b)) / 25;
            }
        double guides = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            guides += std::pow((layer("normal", px, py, c) - layer("normal", qx, qy, c)) / 0.7, 2);
            guides += std::pow((layer("albedo", px, py, c) - layer("albedo", qx, qy, c)) / 0.3, 2);
        }
        const auto depth = [this](int x, int y) {
            const double z = layer("depth", x, y, 0);
            return z > 0 ? std::log(z) / 0.05 : 0;
        };
        return std::max(light, 0.0) + guides + std::pow(depth(px, py) - depth(qx, qy), 2);
    }

    const shade::Film& film_;
};

}  // namespace stratum::test
