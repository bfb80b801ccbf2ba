// Pictures for a page.
#pragma once

#include "shade/film/film.h"

#include <string>

namespace stratum::study {

/// The mean of every `factor` x `factor` pixels; those left over at the right and lower edge are dropped. Layers are
/// too. The film must be a whole frame of at least that many pixels each way.
shade::Film thumbnail(const shade::Film& film, int factor);

/// That picture as a JPEG, in base64.
std::string jpegOf(const shade::Film& film, int factor = 1);

}  // namespace stratum::study
