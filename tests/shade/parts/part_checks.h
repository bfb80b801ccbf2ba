// A picture whose values show where they are, and its parts.
#pragma once

#include "scratch_folder.h"
#include "shade/parts/part.h"

#include <cstddef>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

namespace stratum::test {

constexpr shade::PixelBox kPartFrame{0, 0, 100, 70};

// Values that show where they are, with some that text or arithmetic would not keep.
inline shade::Film wholeFilm() {
    shade::Film film(100, 70, kPartFrame);
    film.layers() = {{"normal", {"X", "Y", "Z"}, std::vector<float>(film.pixels().size() * 3)},
                     {"mask", {"V"}, std::vector<float>(film.pixels().size())}};
    for (std::size_t n = 0; n < film.pixels().size(); ++n) {
        const auto v = static_cast<float>(n);
        film.pixels()[n] = {shade::Color(v, 1.0f / (v + 1.0f), -v), 0.1f * v};
        for (std::size_t c = 0; c < 3; ++c) film.layers()[0].values[3 * n + c] = v + 0.25f * static_cast<float>(c);
        film.layers()[1].values[n] = -v;
    }
    film.pixels()[5].rgb.r = std::numeric_limits<float>::denorm_min();
    film.pixels()[6].rgb.g = std::numeric_limits<float>::infinity();
    film.pixels()[7].rgb.b = -0.0f;
    return film;
}

inline shade::Part partOf(int index, int shards) {
    shade::Part part;
    // From strings: GCC 12 warns wrongly of an overflow where a literal is assigned.
    part.whole.version = std::string("1");
    part.whole.scene = std::string("s");
    part.whole.width = 100;
    part.whole.height = 70;
    part.whole.region = kPartFrame;
    part.whole.linear = true;
    part.whole.shards = shards;
    part.index = index;
    part.samples = 4;
    part.pixels = 2;
    part.metadata = {{"Software", "test"}, {shade::kMeanSamples, std::to_string(index)}};
    return part;
}

inline std::filesystem::path writePartOf(const ScratchFolder& folder, const shade::Part& part,
                                         const shade::Film& film) {
    const std::filesystem::path path = shade::shardName(folder / "p.exr", {part.index, part.whole.shards});
    shade::PictureFile file(path);
    shade::writePart(
        file, film.part(shade::piecesOf(kPartFrame, part.whole.shards).at(static_cast<std::size_t>(part.index))), part);
    return path;
}

}  // namespace stratum::test
