#include "view/picture/still_picture.h"

#include "shade/integrator/deep_light.h"

#include "shade/film/png.h"
#include "shade/film/tonemap.h"
#include "shade/integrator/render.h"
#include "shade/post/denoise.h"

#include <algorithm>
#include <utility>

namespace stratum::view {
namespace {

// Rows of whole tiles. Each band makes integrator and tables anew, so they are few.
int bandRows(int height) {
    constexpr int kBands = 8;
    return std::max(2 * shade::kTile, (height / kBands + shade::kTile - 1) / shade::kTile * shade::kTile);
}

// Copies the rows of a band into the film of the whole frame, layers and all.
void copyBand(const shade::Film& band, shade::Film& whole) {
    if (whole.layers().empty() && !band.layers().empty()) {
        whole.layers() = band.layers();
        for (shade::FilmLayer& layer : whole.layers())
            layer.values.assign(layer.channels.size() * whole.pixels().size(), 0.0f);
    }
    const std::size_t first = whole.index(0, band.region().y0);
    std::copy(band.pixels().begin(), band.pixels().end(), whole.pixels().begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t n = 0; n < band.layers().size(); ++n) {
        const shade::FilmLayer& from = band.layers()[n];
        shade::FilmLayer& to = whole.layers()[n];
        std::copy(from.values.begin(), from.values.end(),
                  to.values.begin() + static_cast<std::ptrdiff_t>(first * to.channels.size()));
    }
}

}  // namespace

StillPicture::StillPicture(ViewedPicture picture, const PicturePlan& plan, std::string source,
                           std::shared_ptr<const assemble::TracedObjects> objects)
    : picture_(std::move(picture)), plan_(plan), source_(std::move(source)), objects_(std::move(objects)) {}

double StillPicture::progress() const {
    return static_cast<double>(next_row_) / static_cast<double>(plan_.options.render.height);
}

void StillPicture::traceBand(const std::function<void()>& check) {
    shade::RenderOptions options = plan_.options.render;
    const int end = std::min(options.height, next_row_ + bandRows(options.height));
    options.crop = shade::PixelBox{0, next_row_, options.width, end};
    options.margin = 0;
    options.integrator.radiance_cache = whole_.radiance_cache;
    if (!cache_work_) cache_work_ = std::make_shared<shade::RadianceCacheWork>();
    options.integrator.cache_work = cache_work_;
    const shade::RenderResult band =
        shade::render(*picture_.print, picture_.scene, options, [&check](std::uint64_t, std::uint64_t) { check(); });
    if (next_row_ == 0) {
        whole_.film =
            shade::Film(options.width, options.height, {0, 0, options.width, options.height}, band.film.content());
        if (band.film.transparent()) whole_.film.makeTransparent(band.film.bareBed());
    }
    copyBand(band.film, whole_.film);
    whole_.radiance_cache = band.radiance_cache;
    whole_.rays += band.rays;
    whole_.samples += band.samples;
    whole_.pixels += band.pixels;
    next_row_ = end;
}

void StillPicture::finish(const std::function<void()>& check) {
    whole_.mean_spp = static_cast<double>(whole_.samples) / static_cast<double>(whole_.pixels);
    if (!plan_.denoise) return;
    const std::vector<shade::Pixel> noisy = whole_.film.pixels();
    try {
        shade::denoise(whole_.film, [&check](std::uint64_t, std::uint64_t) { check(); });
    } catch (...) {
        whole_.film.pixels() = noisy;
        throw;
    }
}

std::vector<std::uint8_t> StillPicture::png() const {
    const shade::RenderOptions& render = plan_.options.render;
    shade::Metadata metadata = assemble::metadataOf(source_, render, plan_.options.scene.env, *objects_, picture_.scene,
                                                    whole_, plan_.denoise);
    if (whole_.film.content() == shade::FilmContent::radiance) metadata.insert(assemble::exposureFact(picture_.tone));
    const shade::Legend* legend = plan_.legend && !objects_->legends.empty() ? &objects_->legends.front() : nullptr;
    return shade::encodePng(render.width, render.height, shade::displayPixels(whole_.film, picture_.tone, legend),
                            metadata);
}

}  // namespace stratum::view
