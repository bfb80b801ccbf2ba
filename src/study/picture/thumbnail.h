// Pictures small enough for a page.
#pragma once

#include "shade/film/film.h"

#include <filesystem>

namespace stratum::study {

/// The mean of every `factor` x `factor` pixels; those left over at the right and lower edge are dropped. Layers are
/// too. The film must be a whole frame of at least that many pixels each way.
shade::Film thumbnail(const shade::Film& film, int factor);

/// Writes that picture with the mark of this program, so that the next study may replace it.
void writeThumbnail(const std::filesystem::path& path, const shade::Film& film, int factor);

}  // namespace stratum::study
