#include "shade/parts/part.h"

#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/json_text.h"
#include "shade/film/exr.h"
#include "shade/film/exr_bytes.h"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <utility>

namespace stratum::shade {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kAttribute = "StratumPart";
constexpr int kFormat = 4;
constexpr std::size_t kMostPixels = std::size_t{1} << 30;  // 32768 x 32768, what a render may have

/// A number that its type holds, where Json::get() casts any.
template <typename Number>
Number numberOf(const Json& json) {
    bool held = false;
    if constexpr (std::is_floating_point_v<Number>)
        held = json.is_number() && std::abs(json.get<double>()) <= double{std::numeric_limits<Number>::max()};
    else if (json.is_number_unsigned())
        held = std::in_range<Number>(json.get<std::uint64_t>());
    else if (json.is_number_integer())
        held = std::in_range<Number>(json.get<std::int64_t>());
    if (!held) throw std::runtime_error("one of its numbers is out of range");
    return json.get<Number>();
}

Json jsonOf(const PixelBox& box) { return {box.x0, box.y0, box.x1, box.y1}; }

PixelBox boxOf(const Json& json) {
    return {numberOf<int>(json.at(0)), numberOf<int>(json.at(1)), numberOf<int>(json.at(2)), numberOf<int>(json.at(3))};
}

Json jsonOf(const Color& color) { return {color.r, color.g, color.b}; }

Color colorOf(const Json& json) {
    return {numberOf<float>(json.at(0)), numberOf<float>(json.at(1)), numberOf<float>(json.at(2))};
}

Json jsonOf(const Legend& legend) {
    Json entries = Json::array();
    for (const Legend::Entry& entry : legend.entries) entries.push_back({entry.name, jsonOf(entry.color)});
    Json ramp = Json::array();
    for (const Color& color : legend.ramp) ramp.push_back(jsonOf(color));
    return {{"title", legend.title}, {"unit", legend.unit},   {"entries", entries},
            {"ramp", ramp},          {"least", legend.least}, {"most", legend.most}};
}

Legend legendOf(const Json& json) {
    Legend legend{json.at("title"),
                  json.at("unit"),
                  {},
                  {},
                  numberOf<double>(json.at("least")),
                  numberOf<double>(json.at("most"))};
    for (const Json& entry : json.at("entries"))
        legend.entries.push_back({entry.at(0).get<std::string>(), colorOf(entry.at(1))});
    for (const Json& color : json.at("ramp")) legend.ramp.push_back(colorOf(color));
    return legend;
}

Json jsonOf(const PartWhole& whole) {
    return {{"version", whole.version},
            {"scene", whole.scene},
            {"size", {whole.width, whole.height}},
            {"region", jsonOf(whole.region)},
            {"crop", whole.crop ? jsonOf(*whole.crop) : Json()},
            {"linear", whole.linear},
            {"denoised", whole.denoised},
            {"exposure", whole.exposure},
            {"bare_bed", whole.bare_bed ? Json(*whole.bare_bed) : Json()},
            {"legend", whole.legend ? jsonOf(*whole.legend) : Json()},
            {"shards", whole.shards}};
}

PartWhole wholeOf(const Json& json) {
    PartWhole whole;
    whole.version = json.at("version");
    whole.scene = json.at("scene");
    whole.width = numberOf<int>(json.at("size").at(0));
    whole.height = numberOf<int>(json.at("size").at(1));
    whole.region = boxOf(json.at("region"));
    if (!json.at("crop").is_null()) whole.crop = boxOf(json.at("crop"));
    whole.linear = json.at("linear");
    whole.denoised = json.at("denoised");
    whole.exposure = numberOf<double>(json.at("exposure"));
    if (!json.at("bare_bed").is_null()) whole.bare_bed = numberOf<float>(json.at("bare_bed"));
    if (!json.at("legend").is_null()) whole.legend = legendOf(json.at("legend"));
    whole.shards = numberOf<int>(json.at("shards"));
    return whole;
}

Json layersOf(const std::vector<FilmLayer>& layers) {
    Json json = Json::array();
    for (const FilmLayer& layer : layers) json.push_back({layer.name, layer.channels});
    return json;
}

std::uint32_t crcOf(std::uint32_t before, const Film& film) {
    std::uint32_t crc = checksumOf(film.pixels().data(), film.pixels().size(), before);
    for (const FilmLayer& layer : film.layers()) crc = checksumOf(layer.values.data(), layer.values.size(), crc);
    return crc;
}

std::uint32_t crcOf(const Json& json, const Metadata& metadata) {
    std::string text = jsonText(json);
    for (const auto& [name, value] : metadata) text += fmt::format("\n{}\n{}", name, value);
    return checksumOf(text);
}

[[noreturn]] void damaged(const std::filesystem::path& path, std::string_view why) {
    throw InputError(fmt::format("{}: is damaged ({}); trace this shard again", path.string(), why));
}

Part partOf(const std::string& text, const Metadata& metadata) {
    Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw std::runtime_error("its description is no JSON");
    Part part;
    part.metadata = metadata;
    if (numberOf<int>(json.at("format")) != kFormat) throw std::runtime_error("its format is of another version");
    part.whole = wholeOf(json.at("whole"));
    part.index = numberOf<int>(json.at("index"));
    part.piece = boxOf(json.at("piece"));
    part.samples = numberOf<std::uint64_t>(json.at("samples"));
    part.pixels = numberOf<std::uint64_t>(json.at("pixels"));
    part.content = static_cast<FilmContent>(numberOf<int>(json.at("content")));
    for (const Json& layer : json.at("layers")) {
        part.layers.push_back({layer.at(0).get<std::string>(), layer.at(1).get<std::vector<std::string>>(), {}});
    }
    part.crc = numberOf<std::uint32_t>(json.at("crc"));
    json.erase("crc");
    part.head = crcOf(json, metadata);
    return part;
}

/// What it says must be possible, before memory is allocated for it.
void check(const Part& part) {
    const auto inside = [](const PixelBox& box, const PixelBox& outer) {
        return box.x0 >= outer.x0 && box.y0 >= outer.y0 && box.x1 <= outer.x1 && box.y1 <= outer.y1 &&
               box.x0 < box.x1 && box.y0 < box.y1;
    };
    const PartWhole& whole = part.whole;
    RenderOptions size;
    size.width = whole.width;
    size.height = whole.height;
    size.validate();
    ToneOptions{whole.exposure}.validate();
    if (!inside(whole.region, {0, 0, whole.width, whole.height}) || (whole.crop && !inside(*whole.crop, whole.region)))
        throw std::runtime_error("its region is not in the picture");
    if (part.index < 0 || part.index >= whole.shards || part.pixels < 1 || part.content < FilmContent::radiance ||
        part.content > FilmContent::position)
        throw std::runtime_error("its numbers are impossible");
    if (part.piece != piecesOf(whole.region, whole.shards).at(static_cast<std::size_t>(part.index)))
        throw std::runtime_error("its place is not that of its number, so it would overlap others");
}

/// So many layers as it states: before memory is allocated for them.
void checkChannels(const Part& part, const Imf::ChannelList& channels) {
    for (const FilmLayer& layer : part.layers)
        for (const std::string& channel : layer.channels)
            if (!channels.findChannel(layer.name + "." + channel))
                throw std::runtime_error(fmt::format("its channel {}.{} is missing", layer.name, channel));
}

Json headOf(const Film& film, const Part& part) {
    return {{"format", kFormat},
            {"whole", jsonOf(part.whole)},
            {"index", part.index},
            {"piece", jsonOf(film.region())},
            {"samples", part.samples},
            {"pixels", part.pixels},
            {"content", static_cast<int>(film.content())},
            {"layers", layersOf(film.layers())}};
}

}  // namespace

void writePart(PictureFile& file, const Film& film, Part part) {
    Json json = headOf(film, part);
    json["crc"] = crcOf(crcOf(json, part.metadata), film);
    part.metadata[kAttribute] = jsonText(json);
    file.write(film, part.metadata);
}

Part readPart(const std::filesystem::path& path) {
    const InputFile input(path);
    if (!isExr(input.bytes()))
        throw InputError(fmt::format("{}: is no OpenEXR; name the parts that vdbtrace --shard wrote", path.string()));
    checkExrHeader(input.bytes(), kMostPixels, path.string());
    try {
        ExrBytes stream(input.bytes(), path.string());
        const Imf::InputFile file(stream, 1);
        Metadata metadata;
        for (auto i = file.header().begin(); i != file.header().end(); ++i)
            if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute()))
                metadata[i.name()] = text->value();
        const auto own = metadata.extract(kAttribute);
        if (own.empty())
            throw InputError(
                fmt::format("{}: is no part of a picture; name those that vdbtrace --shard wrote", path.string()));
        Part part = partOf(own.mapped(), metadata);
        check(part);
        checkChannels(part, file.header().channels());
        const Imath::Box2i window = file.header().dataWindow();
        if (part.piece != PixelBox{window.min.x, window.min.y, window.max.x + 1, window.max.y + 1})
            throw std::runtime_error("its data window is not its piece");
        return part;
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        damaged(path, error.what());
    }
}

void addLayers(const Part& part, Film& film) {
    film.layers() = part.layers;
    for (FilmLayer& layer : film.layers()) layer.values.resize(film.pixels().size() * layer.channels.size());
}

void readPixels(const std::filesystem::path& path, const Part& part, Film& film) {
    try {
        Imf::InputFile file(path.c_str(), 1);
        file.setFrameBuffer(exrBufferOf(film));
        file.readPixels(part.piece.y0, part.piece.y1 - 1);
    } catch (const std::exception& error) {
        damaged(path, error.what());
    }
    if (crcOf(part.head, film.part(part.piece)) != part.crc) damaged(path, "its checksum is wrong");
}

bool isPartOf(const std::filesystem::path& path, const std::string& version, const std::string& scene,
              const Shard& shard) {
    try {
        const Part part = readPart(path);
        if (part.whole.version != version || part.whole.scene != scene || part.index != shard.index ||
            part.whole.shards != shard.count)
            return false;
        Film film(part.whole.width, part.whole.height, part.piece, part.content);
        addLayers(part, film);
        readPixels(path, part, film);
        return true;
    } catch (const InputError&) {
        return false;  // missing or damaged: it is traced again
    }
}

std::string differenceOf(const Part& part, const Part& other) {
    if (part.whole.version != other.whole.version)
        return fmt::format("made by version {}, not {}", part.whole.version, other.whole.version);
    if (part.whole.shards != other.whole.shards)
        return fmt::format("one of {} shards, not of {}", part.whole.shards, other.whole.shards);
    if (part.whole.scene != other.whole.scene)
        return "of another scene: the input files, the options, the seed or the frame differ";
    const auto shared = [](Metadata metadata) {
        metadata.erase(kMeanSamples);
        return metadata;
    };
    if (jsonOf(part.whole) != jsonOf(other.whole) || shared(part.metadata) != shared(other.metadata) ||
        part.content != other.content || layersOf(part.layers) != layersOf(other.layers))
        return "of another picture of the same scene";
    return {};
}

}  // namespace stratum::shade
