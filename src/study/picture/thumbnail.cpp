#include "study/picture/thumbnail.h"

#include "base/base64.h"
#include "shade/film/lossy_writers.h"
#include "shade/film/tonemap.h"

#include <cstdint>
#include <vector>

namespace stratum::study {

shade::Film thumbnail(const shade::Film& film, int factor) {
    const int width = film.width() / factor;
    const int height = film.height() / factor;
    const float share = 1.0f / static_cast<float>(factor * factor);
    shade::Film small(width, height, {0, 0, width, height}, film.content());
    for (int y = 0; y < height * factor; ++y)
        for (int x = 0; x < width * factor; ++x) {
            shade::Pixel& sum = small.at(x / factor, y / factor);
            sum.rgb += film.at(x, y).rgb * share;
            sum.alpha += film.at(x, y).alpha * share;
        }
    return small;
}

std::string jpegOf(const shade::Film& film, int factor) {
    const shade::Film small = thumbnail(film, factor);
    const std::vector<std::uint8_t> bytes =
        shade::encodeJpeg(small.width(), small.height(), shade::toDisplay(small), 90);
    return base64Of({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace stratum::study
