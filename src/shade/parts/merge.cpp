#include "shade/parts/merge.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "shade/post/denoise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostNamed = 20;  // of problems, so that a message stays readable

/// A part and its file.
struct PartFile {
    std::filesystem::path path;
    Part part;
};

/// Throws InputError with what is wrong with parts, a line each.
[[noreturn]] void refuseParts(std::vector<std::string> problems) {
    const std::size_t more = problems.size() - std::min(problems.size(), kMostNamed);
    problems.resize(problems.size() - more);
    if (more > 0) problems.push_back(fmt::format("and {} more", more));
    throw InputError(fmt::format("{}\nnothing is written", fmt::join(problems, "\n")));
}

/// All parts of one picture, each once, by number. Throws InputError that names each part that is missing, doubled,
/// unreadable or foreign.
std::vector<PartFile> readParts(const std::vector<std::filesystem::path>& paths) {
    std::vector<std::string> problems;
    std::vector<PartFile> found;
    for (const std::filesystem::path& path : paths) {
        try {
            found.push_back({path, readPart(path)});
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        }
    }
    if (found.empty()) refuseParts(std::move(problems));
    const PartFile& first = found.front();
    std::vector<PartFile*> places(static_cast<std::size_t>(first.part.whole.shards));
    for (PartFile& one : found) {
        const std::string differs = differenceOf(one.part, first.part);
        if (!differs.empty()) {
            problems.push_back(
                fmt::format("{}: is {}, compared with {}", one.path.string(), differs, first.path.string()));
            continue;
        }
        PartFile*& place = places[static_cast<std::size_t>(one.part.index)];
        if (place)
            problems.push_back(fmt::format("{}: is shard {} of {}, as {} is; name each once", one.path.string(),
                                           one.part.index, places.size(), place->path.string()));
        else
            place = &one;
    }
    for (std::size_t n = 0; n < places.size(); ++n)
        if (!places[n])
            problems.push_back(fmt::format("shard {} of {} is missing; trace it with --shard {}/{}", n, places.size(),
                                           n, places.size()));
    if (!problems.empty()) refuseParts(std::move(problems));
    std::vector<PartFile> sorted;
    sorted.reserve(places.size());
    for (PartFile* place : places) sorted.push_back(std::move(*place));
    return sorted;
}

Film assemble(const std::vector<PartFile>& parts) {
    const Part& any = parts.front().part;
    Film film(any.whole.width, any.whole.height, any.whole.region, any.content);
    addLayers(any, film);
    if (any.whole.bare_bed) film.makeTransparent(*any.whole.bare_bed);
    std::vector<std::string> problems(parts.size());
    parallelFor(parts.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) {
            try {
                readPixels(parts[n].path, parts[n].part, film);
            } catch (const InputError& error) {
                problems[n] = error.what();
            }
        }
    });
    std::erase(problems, "");
    if (!problems.empty()) refuseParts(problems);
    return film;
}

}  // namespace

MergedPicture mergeParts(const std::filesystem::path& output, const std::vector<std::filesystem::path>& paths) {
    PictureFile picture(output);
    const std::vector<PartFile> parts = readParts(paths);
    const Part& any = parts.front().part;
    requirePictureSize(output, any.whole.width, any.whole.height);
    if (picture.linear() != any.whole.linear)
        throw UsageError(fmt::format(
            "{}: the parts are of {}; give the merge such a name, or trace them again with -o {}", output.string(),
            any.whole.linear ? "an .exr, linear" : "a picture to look at, e.g. a .png, with its exposure and denoising",
            output.string()));
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
    const double mean_spp = static_cast<double>(samples) / static_cast<double>(pixels);
    Metadata metadata = any.metadata;
    metadata[kMeanSamples] = fmt::format("{:g}", mean_spp);
    picture.write(film, metadata, {any.whole.exposure}, any.whole.legend ? &*any.whole.legend : nullptr);
    return {film.width(), film.height(), any.whole.shards, mean_spp, any.whole.denoised};
}

}  // namespace stratum::shade
