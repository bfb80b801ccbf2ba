#include "shade/film/exr_buffer.h"

#include <array>
#include <cstddef>
#include <string>
#include <type_traits>

namespace stratum::shade {

Imf::FrameBuffer exrBufferOf(const Film& film) {
    constexpr std::size_t kChannels = 4;
    constexpr std::array<const char*, kChannels> kNames = {"R", "G", "B", "A"};
    static_assert(sizeof(Pixel) == kChannels * sizeof(float) && std::is_standard_layout_v<Pixel>);
    const PixelBox& region = film.region();
    // Inclusive corners. OpenEXR addresses pixels by frame coordinates: its base is where (0, 0) would be.
    const Imath::Box2i place(Imath::V2i(region.x0, region.y0), Imath::V2i(region.x1 - 1, region.y1 - 1));
    const auto row = static_cast<std::size_t>(film.width());
    auto* const pixels = reinterpret_cast<float*>(const_cast<Pixel*>(film.pixels().data()));
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < kChannels; ++c)
        buffer.insert(kNames[c], Imf::Slice::Make(Imf::FLOAT, pixels + c, place, sizeof(Pixel), sizeof(Pixel) * row));
    for (const FilmLayer& layer : film.layers()) {
        const std::size_t pixel = sizeof(float) * layer.channels.size();
        for (std::size_t c = 0; c < layer.channels.size(); ++c)
            buffer.insert(
                layer.name + "." + layer.channels[c],
                Imf::Slice::Make(Imf::FLOAT, const_cast<float*>(layer.values.data()) + c, place, pixel, pixel * row));
    }
    return buffer;
}

}  // namespace stratum::shade
