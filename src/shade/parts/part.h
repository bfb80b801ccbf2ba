// A part of a picture that one of several processes traced: an EXR that says what it is a part of. It holds the pixels
// of a piece of the picture.
#pragma once

#include "shade/film/film.h"
#include "shade/film/picture.h"
#include "shade/integrator/render.h"
#include "shade/parts/shard.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stratum::shade {

/// The name of the metadata that is each part's own: the mean number of samples.
constexpr const char* kMeanSamples = "SamplesPerPixel";

/// What all parts of a picture have in common: all that makes the finished picture out of their pixels.
struct PartWhole {
    std::string version;  ///< of the program
    std::string scene;    ///< hash of the input files and of the options that the picture depends on
    int width = 0, height = 0;
    PixelBox region;               ///< of all parts together: the frame, or a crop with the margin of the denoiser
    std::optional<PixelBox> crop;  ///< of the finished picture
    bool linear = false;           ///< it is an .exr, else a picture to look at
    bool denoised = false;
    double exposure = 0.0;  ///< stops, of a picture to look at
    std::optional<Legend> legend;
    int shards = 1;
    std::optional<float> bare_bed = std::nullopt;  ///< Film::bareBed(), of a transparent picture
};

struct Part {
    PartWhole whole;
    int index = 0;                          ///< of the shard
    PixelBox piece;                         ///< its pixels
    std::uint64_t samples = 0, pixels = 0;  ///< RenderResult::samples and pixels
    FilmContent content = FilmContent::radiance;
    std::vector<FilmLayer> layers;  ///< without values
    std::uint32_t head = 0;         ///< CRC-32 of all that is said of the pixels
    std::uint32_t crc = 0;          ///< CRC-32 of that and of all values
    Metadata metadata;              ///< of the picture; its mean number of samples is the part's own
};

/// Writes a part. Content, layers and checksums are taken from the film, whose region is the piece. Throws OutputError.
void writePart(PictureFile& file, const Film& film, Part part);

/// Reads what a part says of itself. Throws InputError for other files and damaged ones.
Part readPart(const std::filesystem::path& path);

/// Gives a film the layers of a part, without values.
void addLayers(const Part& part, Film& film);

/// Reads its pixels into their place in `film`, which has its layers. Throws InputError.
void readPixels(const std::filesystem::path& path, const Part& part, Film& film);

/// Whether there is such a file, and it is that shard's part of that scene by that version, undamaged.
bool isPartOf(const std::filesystem::path& path, const std::string& version, const std::string& scene,
              const Shard& shard);

/// The differences of two parts that can't be of one picture, e.g. "of another scene"; empty if they can.
std::string differenceOf(const Part& part, const Part& other);

}  // namespace stratum::shade
