#include "shade/film/exr_writer.h"

#include "base/error.h"
#include "shade/film/exr_buffer.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <stdexcept>

namespace stratum::shade {

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

    for (const char* name : {"R", "G", "B", "A"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    for (const FilmLayer& layer : film.layers())
        for (const std::string& channel : layer.channels)
            header.channels().insert(layer.name + "." + channel, Imf::Channel(Imf::FLOAT));
    try {
        // The bytes don't depend on the number of threads.
        const auto threads =
            static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
        if (Imf::globalThreadCount() < threads) Imf::setGlobalThreadCount(threads);
        Imf::OutputFile file(path.c_str(), header, threads);
        file.setFrameBuffer(exrBufferOf(film));
        file.writePixels(film.height());
    } catch (const std::exception& error) {
        throw OutputError(fmt::format("{}: could not be written ({}); is the disk full?", path.string(), error.what()));
    }
}

}  // namespace stratum::shade
