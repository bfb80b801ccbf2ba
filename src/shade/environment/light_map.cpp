#include "shade/environment/light_map.h"

#include "base/error.h"
#include "base/input_file.h"
#include "shade/environment/hdr_reader.h"
#include "shade/film/exr.h"
#include "shade/primaries.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::shade {
namespace {

/// Of a map's radiance, what may be negative. Resampled skies have 1e-6 to 1e-4.
constexpr double kMostNegative = 0.02;

LightMap fromExr(const std::filesystem::path& path) {
    ExrImage image = readExr(path, kMostMapTexels);
    if (const auto matrix = toRec709(image.primaries)) convert(image.rgb, *matrix);
    return {image.width, image.height, std::move(image.rgb)};
}

}  // namespace

LightMap readLightMap(const std::filesystem::path& path, double stops) {
    const InputFile file(path);
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
    double total = 0.0;
    double negative = 0.0;
    const auto scale = static_cast<float>(std::exp2(stops));
    for (std::size_t i = 0; i < map.texels.size(); ++i) {
        Color& c = map.texels[i];
        if (!isFinite(c))
            throw InputError(fmt::format("{}: texel {}, {} is ({}, {}, {}); radiance must be a number", name,
                                         i % static_cast<std::size_t>(map.width),
                                         i / static_cast<std::size_t>(map.width), c.r, c.g, c.b));
        // Filters that sharpen, and colors outside of Rec. 709, leave a little light below 0.
        for (int k = 0; k < 3; ++k) {
            total += static_cast<double>(std::abs(c[k]));
            negative += static_cast<double>(std::max(-c[k], 0.0f));
            c[k] = std::max(c[k], 0.0f);
        }
        c *= scale;
        if (!(maxComponent(c) <= kBrightestTexel))
            throw InputError(
                fmt::format("{}: texel {}, {} has the radiance {:g}, at {:g} stops; at most {:g} can be used. Lower "
                            "--env-exposure, "
                            "or scale the map",
                            name, i % static_cast<std::size_t>(map.width), i / static_cast<std::size_t>(map.width),
                            maxComponent(c), stops, kBrightestTexel));
        black = black && !(maxComponent(c) > 0.0f);
    }
    if (negative > kMostNegative * total)
        throw InputError(fmt::format("{}: {:.1f} % of the radiance is below 0; at most {:g} % can be taken as 0", name,
                                     100.0 * negative / total, 100.0 * kMostNegative));
    if (black)
        throw InputError(fmt::format("{}: is black all over{} and gives no light", name,
                                     stops != 0.0 ? fmt::format(" at {:g} stops", stops) : ""));
    return map;
}

}  // namespace stratum::shade
