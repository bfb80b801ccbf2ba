#include "python/options/picture_options.h"

#include "python/options/print_options.h"

#include "assemble/print/print_colors.h"
#include "base/error.h"
#include "shade/palette/color_name.h"
#include "shade/scene/bed.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

namespace stratum::python {

namespace {

constexpr std::array<std::pair<std::string_view, bool>, 2> kFrames = {{{"part", false}, {"all", true}}};
constexpr std::array<std::pair<std::string_view, bool>, 2> kNormals = {{{"geometric", false}, {"smooth", true}}};
constexpr std::array<std::pair<std::string_view, bool>, 2> kBackgrounds = {{{"scene", false}, {"none", true}}};
constexpr std::array<std::pair<std::string_view, march::BrickValues>, 2> kBrickValues = {
    {{"int16", march::BrickValues::Int16}, {"float", march::BrickValues::Float32}}};

// Whole numbers of a sequence, as many as expected.
template <std::size_t N>
std::optional<std::array<int, N>> integersOf(Keywords& options, std::string_view name, std::string_view expected) {
    const std::vector<double> numbers = options.numbers(name);
    if (numbers.empty()) return std::nullopt;
    std::array<int, N> integers{};
    for (std::size_t n = 0; n < N; ++n) {
        if (numbers.size() != N || std::abs(numbers[n]) > 1e9 || numbers[n] != std::floor(numbers[n]))
            options.fail(name, expected);
        integers[n] = static_cast<int>(numbers[n]);
    }
    return integers;
}

void readRender(Keywords& options, RenderCall& call) {
    shade::RenderOptions& render = call.picture.render;
    if (const auto size = integersOf<2>(options, "size", "(width, height) in pixels")) {
        render.width = (*size)[0];
        render.height = (*size)[1];
    }
    constexpr int kMost = std::numeric_limits<int>::max();
    assign(render.noise, options.number("noise"));
    assign(render.seconds, options.number("seconds"));
    const auto spp = options.integer("spp", 1, kMost);
    call.spp_given = spp.has_value();
    if (spp)
        render.spp = *spp;
    else if (render.noise > 0 || render.seconds > 0)
        render.spp = 4096;
    if (const auto seed = options.integer("seed", 0, kMost)) render.seed = static_cast<std::uint32_t>(*seed);
    if (const auto c = integersOf<4>(options, "crop", "(x0, y0, x1, y1) in pixels"))
        render.crop = shade::PixelBox{(*c)[0], (*c)[1], (*c)[2], (*c)[3]};
    if (const std::vector<std::string> aovs = options.texts("aov"); !aovs.empty())
        render.aovs = shade::parseAovs(fmt::format("{}", fmt::join(aovs, ",")));
    call.denoise = options.flag("denoise");
    call.legend = options.flag("legend").value_or(false);
    call.exposure = options.number("exposure");
    assign(render.integrator.name, options.text("integrator"));
    assign(render.integrator.bounces, options.integer("bounces", 1, kMost));
    assign(render.integrator.exact_translucency, options.flag("exact_translucency"));
    assign(render.integrator.ao_distance, options.number("ao_distance"));
    if (const std::vector<double> v = options.numbers("phong"); !v.empty()) {
        if (v.size() != 5) options.fail("phong", "(ka, kd, ks, shininess, kr)");
        render.integrator.phong = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                                   static_cast<float>(v[3]), static_cast<float>(v[4])};
    }
}

void readCamera(Keywords& options, RenderCall& call) {
    shade::CameraOptions& camera = call.picture.scene.camera;
    if (const auto view = options.text("view")) camera.view = shade::parseView(*view);
    if (const auto eye = options.point("eye")) camera.eye = *eye;
    if (const auto at = options.point("look_at")) camera.look_at = *at;
    if (const auto up = options.point("up")) camera.up = *up;
    assign(camera.fov, options.number("fov"));
    assign(camera.f_number, options.number("f_number"));
    assign(camera.aperture, options.number("aperture"));
    assign(camera.zoom, options.number("zoom"));
    if (const std::vector<double> focus = options.numbers("focus"); !focus.empty()) {
        if (focus.size() != 1 && focus.size() != 3) options.fail("focus", "a distance or a point (x, y, z)");
        if (focus.size() == 1) camera.focus_distance = focus[0];
        if (focus.size() == 3) camera.focus_point = glm::dvec3(focus[0], focus[1], focus[2]);
    }
    assign(call.picture.frame_all, options.choice("frame", kFrames));
}

void readScene(Keywords& options, RenderCall& call) {
    shade::SceneOptions& scene = call.picture.scene;
    assign(scene.brdf, options.text("brdf"));
    if (const std::vector<std::string> colors = options.texts("color"); !colors.empty()) {
        if (!scene.brdf.empty()) throw UsageError("render(): brdf and color both are the material; give one of them");
        if (colors.size() == 1) {
            scene.brdf = shade::colorNamed(colors.front(), "render(): color").brdf;
        } else {
            assemble::ToolColors tools =
                assemble::toolColorsOf(fmt::format("{}", fmt::join(colors, ",")), "render(): color");
            call.tool_colors = std::move(tools.colors);
            call.picture.tracing.finishes = std::move(tools.finishes);
        }
    }
    assign(scene.color_by, options.text("color_by"));
    if (const std::vector<double> ends = options.numbers("color_range"); !ends.empty()) {
        if (ends.size() != 2 || !(ends[0] < ends[1])) options.fail("color_range", "(min, max), the lower one first");
        if (scene.color_by.empty()) throw UsageError("render(): color_range is of color_by; give both");
        scene.color_range = {ends[0], ends[1]};
    }
    assign(scene.smooth_normals, options.choice("normals", kNormals));
    const auto env = options.text("env");
    assign(scene.env, env);
    assign(scene.env_rotation, options.number("env_rotation"));
    if (const auto stops = options.number("env_exposure")) {
        scene.env_exposure = *stops;
        if (!call.exposure) call.exposure = 0.0;
    }
    scene.lights = options.texts("lights");
    assign(scene.bed, options.flag("bed"));
    if (const auto surface = options.text("bed_surface")) scene.bed_surface = shade::parseBedSurface(*surface);
    assign(scene.transparent, options.choice("background", kBackgrounds));
}

void readTracing(Keywords& options, RenderCall& call) {
    assemble::TracingOptions& tracing = call.picture.tracing;
    if (const auto march = options.text("march")) tracing.march = assemble::parseMarchMethod(*march);
    assign(tracing.values, options.choice("brick_values", kBrickValues));
    if (const auto cache = options.text("brick_cache")) {
        if (tracing.march != assemble::MarchMethod::automatic && tracing.march != assemble::MarchMethod::brick)
            throw UsageError(
                fmt::format("render(): brick_cache: march {} has no bricks", assemble::marchMethodName(tracing.march)));
        tracing.brick_cache = static_cast<std::size_t>(std::min(voxelize::parseSize(*cache), 1e18));
    }
    const std::vector<double> clip = options.numbers("clip");
    if (clip.size() % 4 != 0) options.fail("clip", "numbers nx, ny, nz, d, four for each plane");
    for (std::size_t n = 0; n < clip.size(); n += 4)
        tracing.clip.push_back({{clip[n], clip[n + 1], clip[n + 2]}, clip[n + 3]});
    assign(call.grid, options.text("grid"));
    assign(call.file_up, options.text("file_up"));
    if (!call.file_up.empty() && call.file_up != "y" && call.file_up != "z")
        throw UsageError(fmt::format("render(): file_up={}: expected y or z", call.file_up));
    auto sinceLast = [&options, first = options.found().size()]() mutable {
        const std::size_t begin = std::exchange(first, options.found().size());
        return std::vector<std::string>(options.found().begin() + static_cast<std::ptrdiff_t>(begin),
                                        options.found().end());
    };
    tracing.prints.print = printOptionsOf(options, true);
    assign(tracing.prints.printed, options.text("printed"));
    call.of_prints = sinceLast();
    tracing.prints.print.read = readOptionsOf(options);
    call.of_reading = sinceLast();
}

}  // namespace

RenderCall renderCallOf(Keywords& options) {
    RenderCall call;
    readRender(options, call);
    readCamera(options, call);
    readScene(options, call);
    readTracing(options, call);
    call.picture.find_exposure = !call.exposure;
    return call;
}

}  // namespace stratum::python
