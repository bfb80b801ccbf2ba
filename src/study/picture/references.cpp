#include "study/picture/references.h"

#include "base/error.h"
#include "shade/film/exr_reader.h"
#include "shade/film/picture.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kReferenceSeed = 0x5eed1e;  // no picture's

}  // namespace

References::References(fs::path folder, std::string origin, int spp, PictureSubject& subject)
    : folder_(std::move(folder)), origin_(std::move(origin)), spp_(spp), subject_(subject) {
    std::error_code failed;
    fs::create_directories(folder_, failed);
    if (failed) throw OutputError(fmt::format("{}: can't be made: {}", folder_.string(), failed.message()));
}

const shade::Film& References::of(const Reference& reference) {
    auto& known = films_[reference.name];
    if (!known) known = fromFile(reference.name);
    if (!known) {
        known = subject_.render(reference.kind, spp_, kReferenceSeed).film;
        shade::PictureFile(fileOf(reference.name, "exr")).write(*known, {{"Origin", describe(reference.name)}});
    }
    return *known;
}

fs::path References::show(const std::string& name, const shade::Film& film) const {
    fs::path file = fileOf(name, "png");
    shade::PictureFile(file).write(film, {});
    return file;
}

std::string References::describe(const std::string& name) const { return fmt::format("{} {} {}", origin_, spp_, name); }

fs::path References::fileOf(std::string name, const char* extension) const {
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == ' ' || c == ','; }, '_');
    return folder_ / fmt::format("{}.{}", name, extension);
}

std::optional<shade::Film> References::fromFile(const std::string& name) const {
    const fs::path file = fileOf(name, "exr");
    if (!fs::exists(file)) return std::nullopt;
    const auto pixels = static_cast<std::size_t>(subject_.width()) * static_cast<std::size_t>(subject_.height());
    const shade::ExrImage image = shade::readExr(file, pixels);
    const auto origin = image.attributes.find("Origin");
    if (origin == image.attributes.end() || origin->second != describe(name)) return std::nullopt;
    shade::Film film(image.width, image.height, {0, 0, image.width, image.height});
    for (std::size_t n = 0; n < pixels; ++n) film.pixels()[n] = {image.rgb[n], 1.0f};
    return film;
}

}  // namespace stratum::study
