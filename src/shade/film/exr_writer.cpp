#include "shade/film/exr_writer.h"

#include "shade/film/exr_buffer.h"

namespace stratum::shade {

void writeExr(const std::filesystem::path& path, const Film& film, const std::map<std::string, std::string>& metadata) {
    writeExrChannels(path, film, exrBufferOf(film), metadata);
}

}  // namespace stratum::shade
