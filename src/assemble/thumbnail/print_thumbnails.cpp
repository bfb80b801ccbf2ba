#include "assemble/thumbnail/print_thumbnails.h"

#include "assemble/finished_picture.h"
#include "assemble/ready_scene.h"
#include "assemble/thumbnail/bmp_and_qoi.h"
#include "gcode/toolpath/purpose.h"
#include "shade/camera/camera.h"
#include "shade/film/lossy_writers.h"
#include "shade/film/png.h"
#include "shade/post/denoise.h"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

using Pixels = std::vector<std::uint8_t>;

constexpr int kJpegQuality = 90;

StageOptions stageOf(int width, int height) {
    StageOptions stage;
    stage.scene.bed = false;
    stage.scene.transparent = true;
    stage.scene.camera.margin = 0.02;  // a thumbnail has no room to spare
    stage.render.width = width;
    stage.render.height = height;
    return stage;
}

// What slicers leave out of their thumbnails, too: skirts, prime lines and wipe towers.
std::shared_ptr<const gcode::Toolpath> withoutWhatIsBeside(std::shared_ptr<const gcode::Toolpath> toolpath) {
    std::vector<std::uint32_t> all(toolpath->beads.size());
    std::iota(all.begin(), all.end(), 0U);
    const std::vector<std::uint32_t> beads = gcode::beadsUpTo(gcode::Purpose::brim, gcode::purposesOf(*toolpath), all);
    if (beads.size() == all.size()) return toolpath;
    auto part = std::make_shared<gcode::Toolpath>(*toolpath);
    const auto leaveOut = [&beads](auto& of_beads) {
        if (of_beads.empty()) return;
        for (std::size_t n = 0; n < beads.size(); ++n) of_beads[n] = of_beads[beads[n]];
        of_beads.resize(beads.size());
    };
    leaveOut(part->beads);
    leaveOut(part->timing);
    leaveOut(part->flow);
    for (gcode::ColorChange& change : part->color_changes)
        change.first_bead =
            static_cast<std::uint32_t>(std::lower_bound(beads.begin(), beads.end(), change.first_bead) - beads.begin());
    return part;
}

// RGBA of the print in one size.
Pixels drawn(const TracedObjects& objects, StageOptions options, const ReadEvents& events) {
    // Below this a pixel of the denoiser's window is a layer or a wall: samples are cheaper than what it would blur.
    constexpr int kSmall = 96 * 96;
    constexpr int kSamples = 128;
    const bool small = options.render.width * options.render.height <= kSmall;
    if (small) options.render.spp = kSamples;
    const bool denoised = chooseDenoising({small ? std::optional(false) : std::nullopt, false, small}, options.render);
    const Stage stage = makeStage(objects, options, events);
    const Step step(events, "rendering", false);
    shade::RenderResult result = shade::render(*objects.intersector, stage.scene, options.render);
    if (denoised) shade::denoise(result.film);
    return shade::toDisplayWithAlpha(result.film, {stage.exposure.value_or(0.0)});
}

std::string textOf(const Pixels& bytes) { return {bytes.begin(), bytes.end()}; }

std::string encoded(const gcode::ThumbnailSize& size, const Pixels& rgba) {
    switch (size.coding) {
        case gcode::ThumbnailCoding::jpg:
            return textOf(shade::encodeJpeg(size.width, size.height, shade::overBlack(rgba), kJpegQuality));
        case gcode::ThumbnailCoding::qoi:
            return encodeQoi(size.width, size.height, rgba);
        case gcode::ThumbnailCoding::bmp:
            return encodeBmp(size.width, size.height, shade::overBlack(rgba));
        case gcode::ThumbnailCoding::png:
            break;
    }
    return textOf(shade::encodePng(size.width, size.height, rgba, {}));
}

}  // namespace

std::vector<gcode::Thumbnail> makeThumbnails(const std::shared_ptr<const gcode::Toolpath>& toolpath,
                                             const std::string& name, std::span<const gcode::ThumbnailSize> sizes,
                                             const ThumbnailOptions& options) {
    const auto largest =
        *std::max_element(sizes.begin(), sizes.end(), [](const gcode::ThumbnailSize& a, const gcode::ThumbnailSize& b) {
            return a.width * a.height < b.width * b.height;
        });
    StageOptions sharpest = stageOf(largest.width, largest.height);
    TracingOptions tracing;
    tracing.events = options.events;
    tracing.prints.print = options.print;
    tracing.prints.print.voxel_auto = !voxelize::choosesVoxels(options.print);
    tracing.prints.toolpath = options.print.features.empty() ? withoutWhatIsBeside(toolpath) : toolpath;
    tracing.prints.pixel_spread = [&](const voxelize::Bounds& print, const voxelize::Bounds& part,
                                      std::span<const glm::dvec3> outline) {
        return pixelSpreadOf(sharpest, print, part, outline);
    };
    const TracedObjects objects =
        readTracedObjects({{.vdb = name}}, tracingFor(sharpest.scene, sharpest.render, tracing));

    std::map<std::pair<int, int>, Pixels> pictures;
    std::vector<gcode::Thumbnail> thumbnails;
    thumbnails.reserve(sizes.size());
    for (const gcode::ThumbnailSize& size : sizes) {
        Pixels& rgba = pictures[{size.width, size.height}];
        if (rgba.empty()) rgba = drawn(objects, stageOf(size.width, size.height), options.events);
        thumbnails.push_back({size, encoded(size, rgba)});
    }
    return thumbnails;
}

}  // namespace stratum::assemble
