#include "study/picture/thumbnail.h"

#include "shade/film/picture.h"

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

void writeThumbnail(const std::filesystem::path& path, const shade::Film& film, int factor) {
    shade::PictureFile(path).write(thumbnail(film, factor), {{"Software", "vdbstudy " STRATUM_VERSION}});
}

}  // namespace stratum::study
