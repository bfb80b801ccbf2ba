// Where OpenEXR finds the channels of a film in memory, for writing and for reading.
#pragma once

#include "shade/film/film.h"

#include <ImfFrameBuffer.h>

namespace stratum::shade {

/// R, G, B, A and LAYER.CHANNEL of all layers, at the places of the film's region. A file whose data window lies in
/// the region is read into its place. OpenEXR's buffers are never const; for writing the film isn't changed.
Imf::FrameBuffer exrBufferOf(const Film& film);

}  // namespace stratum::shade
