#include "shade/film/exr_writer.h"

#include "base/error.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <array>
#include <cstddef>
#include <stdexcept>
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

void writeExr(const std::filesystem::path& path, const Film& film, const std::map<std::string, std::string>& metadata) {
    const PixelBox& region = film.region();
    // Inclusive corners.
    const Imath::Box2i display(Imath::V2i(0, 0), Imath::V2i(film.frameWidth() - 1, film.frameHeight() - 1));
    const Imath::Box2i data(Imath::V2i(region.x0, region.y0), Imath::V2i(region.x1 - 1, region.y1 - 1));
    Imf::Header header(display, data, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    Imf::addChromaticities(header, Imf::Chromaticities());
    for (const auto& [name, text] : metadata) {
        if (name.empty() || header.find(name.c_str()) != header.end() || name == "channels")
            throw std::invalid_argument(fmt::format("'{}' can't be the name of an EXR attribute of ours", name));
        header.insert(name.c_str(), Imf::StringAttribute(text));
    }
    const Imf::FrameBuffer buffer = exrBufferOf(film);
    for (auto i = buffer.begin(); i != buffer.end(); ++i)
        header.channels().insert(i.name(), Imf::Channel(i.slice().type));
    try {
        // The bytes don't depend on the number of threads.
        const auto threads =
            static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
        if (Imf::globalThreadCount() < threads) Imf::setGlobalThreadCount(threads);
        Imf::OutputFile file(path.c_str(), header, threads);
        file.setFrameBuffer(buffer);
        file.writePixels(film.height());
    } catch (const std::exception& error) {
        throw writeError(path.string(), error.what());
    }
}

}  // namespace stratum::shade
