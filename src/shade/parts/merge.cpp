#include "shade/parts/merge.h"

#include "base/error.h"
#include "shade/post/denoise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostNamed = 20;  // of problems, so that a message stays readable

[[noreturn]] void refuse(std::vector<std::string> problems) {
    const std::size_t more = problems.size() - std::min(problems.size(), kMostNamed);
    problems.resize(problems.size() - more);
    if (more > 0) problems.push_back(fmt::format("and {} more", more));
    throw InputError(fmt::format("{}\nnothing is written", fmt::join(problems, "\n")));
}

struct Found {
    std::filesystem::path path;
    Part part;
};

/// By number, all of one picture, each once.
std::vector<Found> readParts(const std::vector<std::filesystem::path>& paths) {
    std::vector<std::string> problems;
    std::vector<Found> read;
    for (const std::filesystem::path& path : paths) {
        try {
            read.push_back({path, readPart(path)});
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        }
    }
    if (read.empty()) refuse(problems);
    const Found& first = read.front();
    std::vector<const Found*> places(static_cast<std::size_t>(first.part.whole.shards));
    for (const Found& found : read) {
        const std::string difference = differenceOf(found.part, first.part);
        if (!difference.empty()) {
            problems.push_back(
                fmt::format("{}: is {}, compared with {}", found.path.string(), difference, first.path.string()));
            continue;
        }
        const Found*& place = places[static_cast<std::size_t>(found.part.index)];
        if (place)
            problems.push_back(fmt::format("{}: is shard {} of {}, as {} is; name each once", found.path.string(),
                                           found.part.index, places.size(), place->path.string()));
        else
            place = &found;
    }
    for (std::size_t n = 0; n < places.size(); ++n)
        if (!places[n])
            problems.push_back(fmt::format("shard {} of {} is missing; trace it with --shard {}/{}", n, places.size(),
                                           n, places.size()));
    if (!problems.empty()) refuse(problems);
    std::vector<Found> sorted;
    sorted.reserve(places.size());
    for (const Found* place : places) sorted.push_back(*place);
    return sorted;
}

Film assemble(const std::vector<Found>& parts) {
    const Part& any = parts.front().part;
    Film film(any.whole.width, any.whole.height, any.whole.region, any.content);
    addLayers(any, film);
    std::vector<std::string> problems;
    for (const Found& found : parts) {
        try {
            readPixels(found.path, found.part, film);
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        }
    }
    if (!problems.empty()) refuse(problems);
    return film;
}

}  // namespace

MergedPicture mergeParts(const std::filesystem::path& output, const std::vector<std::filesystem::path>& paths) {
    PictureFile picture(output);
    const std::vector<Found> parts = readParts(paths);
    const Part& any = parts.front().part;
    if (picture.linear() != any.whole.linear)
        throw UsageError(fmt::format(
            "{}: the parts are of {}; give the merge such a name, or trace them again with -o {}", output.string(),
            any.whole.linear ? "an .exr, linear" : "a .png, with its exposure and denoising", output.string()));
    Film film = assemble(parts);
    if (any.whole.denoised) {
        denoise(film);
        if (any.whole.crop && film.region() != *any.whole.crop) film = film.part(*any.whole.crop);
    }
    std::uint64_t samples = 0;
    std::uint64_t pixels = 0;
    for (const Found& found : parts) {
        samples += found.part.samples;
        pixels += found.part.pixels;
    }
    const double mean_spp = static_cast<double>(samples) / static_cast<double>(pixels);
    Metadata metadata = any.metadata;
    metadata[kMeanSamples] = fmt::format("{:g}", mean_spp);
    picture.write(film, metadata, {any.whole.exposure}, any.whole.legend ? &*any.whole.legend : nullptr);
    return {film.width(), film.height(), any.whole.shards, mean_spp, any.whole.denoised};
}

}  // namespace stratum::shade
