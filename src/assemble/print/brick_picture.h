// Which bricks of a print a picture asked for, as a picture.
#pragma once

#include "march/brick/brick_grid.h"
#include "shade/film/picture.h"

#include <string>

namespace stratum::assemble {

/// Writes a .png: the print from the front and from above, a square a row of bricks: grey where bricks may have
/// surface, and orange by the share of them that rays came to. Not while rays are traced. Throws UsageError for another
/// kind of file, OutputError.
void writeBrickPicture(const std::string& path, const march::BrickGrid& bricks, const shade::Metadata& metadata);

}  // namespace stratum::assemble
