// Writes films as OpenEXR: linear, in full precision; and where OpenEXR finds a film's channels in memory.
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

/// Overwrites `path` with channels R, G, B, A: 32-bit float, linear, premultiplied, ZIP-compressed, Rec. 709 primaries.
/// The film's layers follow as channels LAYER.CHANNEL. The display window is the frame, the data window the film's
/// region.
/// @param metadata  name -> UTF-8 text, written as string attributes
/// Throws OutputError; std::invalid_argument for a name that is reserved by the format.
void writeExr(const std::filesystem::path& path, const Film& film, const std::map<std::string, std::string>& metadata);

}  // namespace stratum::shade
