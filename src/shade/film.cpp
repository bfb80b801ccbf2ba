#include "shade/film.h"

namespace stratum::shade {

Film::Film(int frame_width, int frame_height, const PixelBox& region, FilmContent content)
    : frame_width_(frame_width),
      frame_height_(frame_height),
      region_(region),
      content_(content),
      pixels_(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height())) {}

}  // namespace stratum::shade
