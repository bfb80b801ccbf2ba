#include "shade/parts/merge.h"

#include "base/error.h"
#include "base/parallel_for.h"
#include "base/part_set.h"
#include "shade/parts/part_sums.h"
#include "shade/post/denoise.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace stratum::shade {
namespace {

/// By number, all of one picture, each once.
std::vector<PartFile> readParts(const std::vector<std::filesystem::path>& paths) {
    return wholeSet<PartFile>(
        paths,
        [](const std::filesystem::path& path) {
            return PartFile{path, readPart(path)};
        },
        [](const PartFile& file) {
            return Shard{file.part.index, file.part.whole.shards};
        },
        [](const PartFile& file, const PartFile& first) { return differenceOf(file.part, first.part); },
        "trace it with");
}

Film assemble(const std::vector<PartFile>& parts) {
    const Part& any = parts.front().part;
    Film film(any.whole.width, any.whole.height, any.whole.region, any.content);
    addLayers(any, film);
    if (any.whole.bare_bed) film.makeTransparent(*any.whole.bare_bed);
    if (any.whole.spp > 0) {
        const std::vector<std::string> problems = addUp(parts, film);
        if (!problems.empty()) refuseParts(problems);
        return film;
    }
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
    if (any.whole.spp > 0) pixels = any.pixels;  // all have the same
    const double mean_spp = static_cast<double>(samples) / static_cast<double>(pixels);
    Metadata metadata = any.metadata;
    metadata[kMeanSamples] = fmt::format("{:g}", mean_spp);
    picture.write(film, metadata, {any.whole.exposure}, any.whole.legend ? &*any.whole.legend : nullptr);
    return {film.width(), film.height(), any.whole.shards, mean_spp, any.whole.denoised};
}

}  // namespace stratum::shade
