#include "shade/film/exr_reader.h"

#include "base/error.h"
#include "base/input_file.h"
#include "shade/film/exr_bytes.h"
#include "shade/film/exr_header.h"

#include <ImfChannelList.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <array>

namespace stratum::shade {
namespace {

std::map<std::string, std::string> attributesOf(const Imf::Header& header) {
    std::map<std::string, std::string> result;
    for (auto i = header.begin(); i != header.end(); ++i) {
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
            result[i.name()] = text->value();
        if (const auto* n = dynamic_cast<const Imf::IntAttribute*>(&i.attribute()))
            result[i.name()] = std::to_string(n->value());
        if (const auto* x = dynamic_cast<const Imf::FloatAttribute*>(&i.attribute()))
            result[i.name()] = fmt::format("{}", x->value());
    }
    return result;
}

ExrImage read(std::string_view bytes, const std::filesystem::path& path, std::size_t most) {
    ExrBytes stream(bytes, path.string());
    Imf::InputFile file(stream, 1);
    const Imath::Box2i window = file.header().dataWindow();
    const auto width = static_cast<std::int64_t>(window.max.x) - window.min.x + 1;
    const auto height = static_cast<std::int64_t>(window.max.y) - window.min.y + 1;
    if (width < 1 || height < 1 || static_cast<std::uint64_t>(width) > most / static_cast<std::uint64_t>(height))
        throw InputError(fmt::format("{}: {} x {} pixels; at most {} can be read. Scale it down", path.string(), width,
                                     height, most));
    const Imf::ChannelList& channels = file.header().channels();
    const bool color = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    if (!color && !channels.findChannel("Y"))
        throw InputError(fmt::format("{}: has neither channels R, G, B nor Y", path.string()));
    for (const char* name : {"R", "G", "B", "Y"}) {
        const Imf::Channel* channel = channels.findChannel(name);
        if (channel && (channel->xSampling != 1 || channel->ySampling != 1))
            throw InputError(
                fmt::format("{}: channel {} is subsampled; save it at full resolution", path.string(), name));
    }

    ExrImage image{static_cast<int>(width), static_cast<int>(height), {}, attributesOf(file.header())};
    image.rgb.resize(static_cast<std::size_t>(width * height));
    const std::array<const char*, 3> names = {color ? "R" : "Y", "G", "B"};
    Imf::FrameBuffer buffer;
    for (std::size_t c = 0; c < (color ? 3u : 1u); ++c)
        buffer.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &image.rgb[0][static_cast<int>(c)], window, sizeof(Color),
                                                 sizeof(Color) * static_cast<std::size_t>(width)));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    if (!color)
        for (Color& p : image.rgb) p = Color(p.r);
    return image;
}

}  // namespace

bool isExr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }

ExrImage readExr(const std::filesystem::path& path, std::size_t most) {
    const InputFile input(path);
    checkExrHeader(input.bytes(), most, path.string());
    try {
        return read(input.bytes(), path, most);
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(
            fmt::format("{}: can't be read as OpenEXR ({}); copy or save it again", path.string(), error.what()));
    }
}

}  // namespace stratum::shade
