#include "shade/parts/merge.h"

#include "base/error.h"
#include "shade/parts/part_sums.h"
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

/// By number, all of one picture, each once.
std::vector<PartFile> readParts(const std::vector<std::filesystem::path>& paths) {
    std::vector<std::string> problems;
    std::vector<PartFile> read;
    for (const std::filesystem::path& path : paths) {
        try {
            read.push_back({path, readPart(path)});
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        }
    }
    if (read.empty()) refuse(problems);
    const PartFile& first = read.front();
    std::vector<const PartFile*> places(static_cast<std::size_t>(first.part.whole.shards));
    for (const PartFile& found : read) {
        const std::string difference = differenceOf(found.part, first.part);
        if (!difference.empty()) {
            problems.push_back(
                fmt::format("{}: is {}, compared with {}", found.path.string(), difference, first.path.string()));
            continue;
        }
        const PartFile*& place = places[static_cast<std::size_t>(found.part.index)];
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
    std::vector<PartFile> sorted;
    sorted.reserve(places.size());
    for (const PartFile* place : places) sorted.push_back(*place);
    return sorted;
}

Film assemble(const std::vector<PartFile>& parts) {
    const Part& any = parts.front().part;
    Film film(any.whole.width, any.whole.height, any.whole.region, any.content);
    addLayers(any, film);
    if (any.whole.spp > 0) {
        const std::vector<std::string> problems = addUp(parts, film);
        if (!problems.empty()) refuse(problems);
        return film;
    }
    std::vector<std::string> problems;
    for (const PartFile& found : parts) {
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
    const std::vector<PartFile> parts = readParts(paths);
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
    for (const PartFile& found : parts) {
        samples += found.part.samples;
        pixels += found.part.pixels;
    }
    if (any.whole.spp > 0) pixels = any.pixels;  // all have the same
    const double mean_spp = static_cast<double>(samples) / static_cast<double>(pixels);
    Metadata metadata = any.metadata;
    metadata[kMeanSamples] = fmt::format("{:g}", mean_spp);
    picture.write(film, metadata, {any.whole.exposure}, any.whole.legend ? &*any.whole.legend : nullptr);
    return {film.width(), film.height(), any.whole.shards, mean_spp, any.whole.denoised};
}

}  // namespace stratum::shade
