// Parts that are a share of the samples: sums of pixels in a file, and their merge.
#pragma once

#include "shade/integrator/pixel_sums.h"
#include "shade/parts/part.h"

#include <ImfFrameBuffer.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace stratum::shade {

/// Where OpenEXR finds the sums of `rows`, of which they are. A double is two channels of 32 bits, so that every bit is
/// kept. For writing the sums aren't changed.
Imf::FrameBuffer exrBufferOf(const PixelSums& sums, const PixelBox& rows);

/// The names of those channels.
std::vector<std::string> channelsOfSums(std::size_t each, std::size_t planes);

/// CRC-32 of what was before and of all sums, row by row: of some rows, it goes on with the next ones.
std::uint32_t crcOf(std::uint32_t before, const PixelSums& sums, const PixelBox& rows);

/// A part and its file.
struct PartFile {
    std::filesystem::path path;
    Part part;
};

/// Adds up the shares, in the order of their samples, and writes the means into `film`, which has their layers. Each
/// thread has some rows of two shares in memory. Returns what is wrong with any of them. Parallel.
std::vector<std::string> addUp(const std::vector<PartFile>& parts, Film& film);

/// Reads all sums of a share and throws InputError if it is damaged.
void checkSums(const PartFile& share);

}  // namespace stratum::shade
