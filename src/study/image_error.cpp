#include "study/image_error.h"

#include "shade/tonemap.h"

#include <glm/common.hpp>

#include <algorithm>
#include <stdexcept>

namespace stratum::study {

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
