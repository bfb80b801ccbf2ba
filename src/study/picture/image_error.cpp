#include "study/picture/image_error.h"

#include "shade/film/tonemap.h"

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <stdexcept>

namespace stratum::study {

constexpr int kAround = 2;  // pixels

double relativeSquaredError(const shade::Film& picture, const shade::Film& reference) {
    if (picture.region() != reference.region()) throw std::invalid_argument("pictures of different sizes");
    double sum = 0;
    for (std::size_t n = 0; n < reference.pixels().size(); ++n)
        for (int c = 0; c < 3; ++c) {
            const auto r = static_cast<double>(reference.pixels()[n].rgb[c]);
            const double d = static_cast<double>(picture.pixels()[n].rgb[c]) - r;
            sum += d * d / (r * r + 0.01);
        }
    return sum / (3.0 * static_cast<double>(reference.pixels().size()));
}

Separated separateNoise(const shade::Film& a1, const shade::Film& a2, const shade::Film& b1, const shade::Film& b2) {
    for (const shade::Film* film : {&a2, &b1, &b2})
        if (film->region() != a1.region()) throw std::invalid_argument("pictures of different sizes");
    Separated result;
    const int width = a1.width();
    const int height = a1.height();
    const auto at = [width](const shade::Film& film, int x, int y) {
        return film
            .pixels()[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]
            .rgb;
    };
    const double values = 3.0 * static_cast<double>(a1.pixels().size());
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // Of one pixel alone it would share the noise of the differences, and the mean of the quotients be off.
            glm::dvec3 around(0);
            int count = 0;
            for (int v = std::max(0, y - kAround); v <= std::min(height - 1, y + kAround); ++v)
                for (int u = std::max(0, x - kAround); u <= std::min(width - 1, x + kAround); ++u) {
                    if (u == x && v == y) continue;
                    for (const shade::Film* film : {&a1, &a2, &b1, &b2}) around += glm::dvec3(at(*film, u, v));
                    count += 4;
                }
            for (int c = 0; c < 3; ++c) {
                const double r = count > 0 ? around[c] / count : 0;
                const double scale = 1 / (values * (r * r + 0.01));
                const auto difference = [&](const shade::Film& p, const shade::Film& q) {
                    return static_cast<double>(at(p, x, y)[c]) - static_cast<double>(at(q, x, y)[c]);
                };
                result.noise += 0.5 * difference(a1, a2) * difference(a1, a2) * scale;
                result.bias += difference(a1, b1) * difference(a2, b2) * scale;
            }
        }
    return result;
}

DisplayPicture displayed(const shade::Film& film) {
    DisplayPicture picture{film.width(), film.height(), {}};
    picture.pixels.reserve(film.pixels().size());
    const bool light = film.content() == shade::FilmContent::radiance;
    for (const shade::Pixel& pixel : film.pixels()) {
        const shade::Color positive = glm::max(pixel.rgb, shade::Color(0.0f));
        const shade::Color linear = light ? shade::toneMapNeutral(positive) : positive;
        shade::Color shown;
        for (int c = 0; c < 3; ++c) shown[c] = std::min(shade::encodeSrgb(linear[c]), 1.0f);
        picture.pixels.push_back(shown);
    }
    return picture;
}

}  // namespace stratum::study
