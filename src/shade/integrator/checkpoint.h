// Checkpoints of a render: a file of the finished tiles, from which it can be resumed.
#pragma once

#include "shade/film/film.h"
#include "shade/integrator/integrator.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace stratum::shade {

/// The finished tiles of a render.
struct RenderState {
    Film film;                       ///< pixels and layers of finished tiles; the others are zero
    std::vector<std::uint8_t> done;  ///< 1 for each finished tile
    RayCounts rays;                  ///< of finished tiles
    std::uint64_t samples = 0;       ///< of finished tiles, all pixels
};

/// The file of a RenderState. Native byte order, one machine's own; guarded by a CRC-32.
class Checkpoint {
public:
    /// @param identity  one line of text that describes everything the picture depends on: files with another are
    /// refused
    Checkpoint(std::filesystem::path path, std::string identity);
    /// Fills `state`, whose film and tiles have their sizes, from the file. Returns false if there is no file yet.
    /// Throws InputError if the file is damaged or belongs to another picture.
    bool read(RenderState& state) const;
    /// The contents of the file for this state.
    std::string bytesOf(const RenderState& state) const;
    /// Replaces the file: a process that is killed meanwhile leaves the one before. Not for two threads at once. Throws
    /// OutputError.
    void write(const std::string& bytes) const;

private:
    std::filesystem::path path_;
    std::string identity_;
};

}  // namespace stratum::shade
