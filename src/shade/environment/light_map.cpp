#include "shade/environment/light_map.h"

#include "base/error.h"
#include "base/mapped_file.h"
#include "shade/environment/hdr_reader.h"
#include "shade/film/exr_reader.h"

#include <fmt/format.h>

namespace stratum::shade {
namespace {

LightMap fromExr(const std::filesystem::path& path) {
    ExrImage image = readExr(path, kMostMapTexels);
    return {image.width, image.height, std::move(image.rgb)};
}

}  // namespace

LightMap readLightMap(const std::filesystem::path& path) {
    const MappedFile file(path);
    const std::string name = path.string();
    LightMap map;
    if (isHdr(file.bytes()))
        map = readHdr(file.bytes(), name);
    else if (isExr(file.bytes()))
        map = fromExr(path);
    else
        throw InputError(fmt::format("{}: is no environment map; expected Radiance .hdr or OpenEXR .exr", name));
    if (map.width != 2 * map.height)
        throw InputError(fmt::format("{}: has {} x {} texels; a map of all directions is twice as wide as high", name,
                                     map.width, map.height));
    bool black = true;
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
        const Color& c = map.texels[i];
        if (!isFinite(c) || std::min({c.r, c.g, c.b}) < 0.0f)
            throw InputError(fmt::format("{}: texel {}, {} is ({}, {}, {}); radiance must be a number and not negative",
                                         name, i % static_cast<std::size_t>(map.width),
                                         i / static_cast<std::size_t>(map.width), c.r, c.g, c.b));
        black = black && !(maxComponent(c) > 0.0f);
    }
    if (black) throw InputError(fmt::format("{}: is black all over and gives no light", name));
    return map;
}

}  // namespace stratum::shade
