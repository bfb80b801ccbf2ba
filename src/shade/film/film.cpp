#include "shade/film/film.h"

#include <algorithm>

namespace stratum::shade {

Film::Film(int frame_width, int frame_height, const PixelBox& region, FilmContent content)
    : frame_width_(frame_width),
      frame_height_(frame_height),
      region_(region),
      content_(content),
      pixels_(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height())) {}

Film Film::part(const PixelBox& region) const {
    Film film(frame_width_, frame_height_, region, content_);
    film.bare_bed_ = bare_bed_;
    for (const FilmLayer& layer : layers_)
        film.layers_.push_back(
            {layer.name, layer.channels, std::vector<float>(film.pixels_.size() * layer.channels.size())});
    for (int y = region.y0; y < region.y1; ++y) {
        const auto from = static_cast<std::ptrdiff_t>(index(region.x0, y));
        const auto to = static_cast<std::ptrdiff_t>(film.index(region.x0, y));
        std::copy_n(pixels_.begin() + from, region.width(), film.pixels_.begin() + to);
        for (std::size_t n = 0; n < layers_.size(); ++n) {
            const auto channels = static_cast<std::ptrdiff_t>(layers_[n].channels.size());
            std::copy_n(layers_[n].values.begin() + channels * from, channels * region.width(),
                        film.layers_[n].values.begin() + channels * to);
        }
    }
    return film;
}

}  // namespace stratum::shade
