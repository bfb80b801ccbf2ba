// Where OpenEXR finds the channels of a film in memory, for writing and for reading; and writing of any channels.
#pragma once

#include "shade/film/film.h"

#include <ImfFrameBuffer.h>

#include <filesystem>
#include <map>
#include <string>

namespace stratum::shade {

/// R, G, B, A and LAYER.CHANNEL of all layers, at the places of the film's region. A file whose data window lies in
/// the region is read into its place. OpenEXR's buffers are never const; for writing the film isn't changed.
Imf::FrameBuffer exrBufferOf(const Film& film);

/// Writes the channels of a buffer, at the place of `film` in its frame, as writeExr does.
void writeExrChannels(const std::filesystem::path& path, const Film& film, const Imf::FrameBuffer& buffer,
                      const std::map<std::string, std::string>& metadata);

}  // namespace stratum::shade
