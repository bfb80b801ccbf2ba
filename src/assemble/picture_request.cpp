#include "assemble/picture_request.h"

#include "assemble/file/object_file.h"
#include "assemble/print/print_colors.h"
#include "shade/palette/color_name.h"
#include "shade/post/denoise.h"
#include "voxelize/grid/voxel_choice.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string_view>
#include <utility>

namespace stratum::assemble {
namespace {

constexpr Names<bool, 2> kFrames = {{{"part", false}, {"all", true}}};
constexpr Names<bool, 2> kNormals = {{{"geometric", false}, {"smooth", true}}};
constexpr Names<bool, 2> kBackgrounds = {{{"scene", false}, {"none", true}}};
constexpr Names<march::BrickValues, 2> kBrickValues = {
    {{"float", march::BrickValues::Float32}, {"int16", march::BrickValues::Int16}}};

/// An option that leaves nothing for others to say.
struct Exclusion {
    std::string_view option;
    std::array<std::string_view, 5> others;
    std::string_view why;
    bool in_scenes = true;  // else a scene may have both, and tells that one of them is not used
};

constexpr std::array<Exclusion, 4> kExclusions = {
    {{"color", {"brdf"}, "both are the material; give one of them"},
     {"color", {"color_by"}, "both are the colour; give one of them"},
     {"view", {"eye"}, "both say where the camera stands; give one of them", false},
     {"photograph",
      {"eye", "look_at", "up", "view", "fov"},
      "a photograph tells where the camera stands, which way it looks and how much it sees"}}};

// The name alone, without the file and the section in front of it.
std::string shortName(const OptionSource& options, std::string_view option) {
    const std::string called = options.called(option);
    return called.substr(called.find_last_of(" .") + 1);
}

// What is expected instead of the row's option; empty if none of the others is there.
std::string expectedBy(const Exclusion& row, const OptionSource& options) {
    for (const std::string_view other : row.others)
        if (!other.empty() && options.given(row.option) && options.given(other))
            return fmt::format("no {} beside it, since {}", shortName(options, other), row.why);
    return {};
}

void refuseTogether(const OptionSource& options, bool in_scenes) {
    for (const Exclusion& row : kExclusions)
        if (const std::string expected = expectedBy(row, options); row.in_scenes == in_scenes && !expected.empty())
            options.refuse(row.option, expected);
}

// Options over a scene take the place of what it says; of a photograph that is only a part.
void tellOfPhotograph(const OptionSource& options, PictureRequest& request) {
    if (!request.photograph) return;
    const Exclusion& row = kExclusions.back();
    for (const std::string_view other : row.others)
        if (options.given(other))
            request.notes.push_back(
                fmt::format("{} takes the place of what the scene's photograph tells", options.called(other)));
}

void readFilm(OptionSource& options, PictureRequest& request) {
    shade::RenderOptions& render = request.render;
    if (const auto size = options.integersOf("size", 2, "the width and the height in pixels, e.g. 1280x960", 'x');
        !size.empty()) {
        render.width = size[0];
        render.height = size[1];
    }
    assign(render.noise, options.number("noise"));
    assign(render.seconds, options.number("seconds"));
    if (const auto spp = options.integer("spp", 1, 65536)) {
        render.spp = static_cast<int>(*spp);
        request.spp_given = true;
    }
    assign(render.seed, options.integer("seed", 0, std::numeric_limits<std::uint32_t>::max()));
    if (const auto c = options.integersOf("crop", 4, "pixels: x0, y0, x1, y1"); !c.empty())
        render.crop = shade::PixelBox{c[0], c[1], c[2], c[3]};
    if (const auto aovs = options.texts("aov"); !aovs.empty())
        render.aovs = shade::parseAovs(fmt::format("{}", fmt::join(aovs, ",")));
    assign(request.denoise, options.flag("denoise"));
    assign(request.legend, options.flag("legend"));
    assign(request.exposure, options.number("exposure"));
    shade::IntegratorOptions& integrator = render.integrator;
    if (const auto name = options.text("integrator")) {
        integrator.name = *name;
        if (!options.flag("denoise") && !shade::canDenoise(integrator)) request.denoise.reset();
    }
    assign(integrator.bounces, options.integer("bounces", 1, 64));
    assign(integrator.exact_translucency, options.flag("exact_translucency"));
    assign(integrator.ao_distance, options.number("ao_distance"));
    if (const auto v = options.numbersOf("phong", {5}, "five numbers: ka, kd, ks, shininess, kr"); !v.empty())
        integrator.phong = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                            static_cast<float>(v[3]), static_cast<float>(v[4])};
}

void readCamera(OptionSource& options, PictureRequest& request) {
    shade::CameraOptions& camera = request.scene.camera;
    // What is given here takes the place of what says the same otherwise.
    if (const auto view = options.choice("view", shade::kViews)) {
        camera.view = *view;
        camera.eye.reset();
        camera.look_at.reset();
        camera.up.reset();
    }
    if (const auto eye = options.point("eye")) camera.eye = eye;
    if (const auto at = options.point("look_at")) camera.look_at = at;
    if (const auto up = options.point("up")) camera.up = up;
    assign(camera.fov, options.number("fov"));
    const auto f_number = options.number("f_number");
    const auto aperture = options.number("aperture");
    if (f_number == 0.0) options.refuse("f_number", "a number above 0, e.g. 2.8");
    if (f_number || aperture) {
        camera.f_number = f_number.value_or(0);
        camera.aperture = aperture.value_or(0);
    }
    assign(camera.zoom, options.number("zoom"));
    if (const auto focus = options.numbersOf("focus", {1, 3}, "a distance or a point x, y, z"); !focus.empty()) {
        camera.focus_distance.reset();
        camera.focus_point.reset();
        if (focus.size() == 1) camera.focus_distance = focus[0];
        if (focus.size() == 3) camera.focus_point = glm::dvec3(focus[0], focus[1], focus[2]);
    }
    assign(request.frame_all, options.choice("frame", kFrames));
}

void readMaterial(OptionSource& options, PictureRequest& request) {
    shade::SceneOptions& scene = request.scene;
    const std::optional<std::string> brdf = options.text("brdf");
    const std::string color = fmt::format("{}", fmt::join(options.texts("color"), ","));
    if (brdf || !color.empty()) {
        scene.brdf = brdf.value_or(std::string());
        request.tool_colors.clear();
        request.tracing.finishes.clear();
    }
    // A scene's colours by an attribute would hide it.
    if (!color.empty()) {
        scene.color_by.clear();
        scene.color_range.reset();
    }
    if (color.find(',') != std::string::npos) {
        ToolColors tools = toolColorsOf(color, options.called("color"));
        request.tool_colors = std::move(tools.colors);
        request.tracing.finishes = std::move(tools.finishes);
    } else if (!color.empty()) {
        scene.brdf = shade::colorNamed(color, options.called("color")).brdf;
    }
    assign(scene.color_by, options.text("color_by"));
    if (const auto range = readColorRange(options, scene.color_by)) scene.color_range = range;
    assign(scene.smooth_normals, options.choice("normals", kNormals));
}

void readLight(OptionSource& options, PictureRequest& request) {
    shade::SceneOptions& scene = request.scene;
    if (const auto env = options.text("env")) {
        scene.env = *env;
        if (scene.env_exposure != 0) request.exposure.reset();  // that of another map
        scene.env_exposure = 0;
    }
    assign(scene.env_rotation, options.number("env_rotation"));
    if (const auto stops = options.number("env_exposure")) {
        scene.env_exposure = *stops;
        if (!request.exposure) request.exposure = 0.0;  // the map has the brightness that was asked for
    }
    if (auto lights = options.texts("lights"); !lights.empty()) scene.lights = std::move(lights);
    assign(scene.bed, options.flag("bed"));
    assign(scene.bed_surface, options.choice("bed_surface", shade::kBedSurfaces));
    assign(scene.transparent, options.choice("background", kBackgrounds));
}

void readTracing(OptionSource& options, PictureRequest& request) {
    TracingOptions& tracing = request.tracing;
    assign(tracing.march, options.choice("march", kMarchMethods));
    assign(tracing.values, options.choice("brick_values", kBrickValues));
    if (const auto cache = brickCacheOf(options)) {
        if (tracing.march != MarchMethod::automatic && tracing.march != MarchMethod::brick)
            options.refuse("brick_cache",
                           fmt::format("no bound: march {} has no bricks", nameOf(kMarchMethods, tracing.march)));
        tracing.brick_cache = *cache;
    }
    constexpr std::size_t kPlane = 4;  // numbers
    if (const std::vector<double> clip = options.list("clip"); !clip.empty()) {
        if (clip.size() % kPlane != 0) options.fail("clip", "four numbers for each plane: nx, ny, nz, d");
        tracing.clip.clear();
        for (std::size_t n = 0; n < clip.size(); n += kPlane)
            tracing.clip.push_back({{clip[n], clip[n + 1], clip[n + 2]}, clip[n + 3]});
    }
    assign(request.grid, options.text("grid"));
    assign(request.file_up, options.choice("file_up", kUps));
}

}  // namespace

void readPicture(OptionSource& options, PictureRequest& request) {
    refuseTogether(options, true);
    tellOfPhotograph(options, request);
    readFilm(options, request);
    readCamera(options, request);
    readMaterial(options, request);
    readLight(options, request);
    readTracing(options, request);
}

void refuseUnused(OptionSource& options, const PictureRequest& request) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kUsers = {
        {{"phong", "phong"}, {"ao_distance", "ao"}, {"bounces", "path"}, {"exact_translucency", "path"}}};
    const std::string& integrator = request.render.integrator.name;
    for (const auto& [option, user] : kUsers)
        if (integrator != user && options.given(option))
            options.refuse(option, fmt::format("integrator {}; {} does not use it", user, integrator));
    refuseTogether(options, false);
}

void tellOfUnused(const OptionSource& options, PictureRequest& request) {
    for (const Exclusion& row : kExclusions)
        if (const std::string expected = expectedBy(row, options); !row.in_scenes && !expected.empty())
            request.notes.push_back(fmt::format("{} is not used: expected {}", options.called(row.option), expected));
}

std::optional<std::size_t> brickCacheOf(OptionSource& options) {
    const std::optional<std::string> size = options.text("brick_cache");
    if (!size) return std::nullopt;
    return static_cast<std::size_t>(std::min(voxelize::parseSize(*size), 1e18));
}

void completeSamples(PictureRequest& request) {
    constexpr int kEnough = 4096;
    if (!request.spp_given && (request.render.noise > 0 || request.render.seconds > 0)) request.render.spp = kEnough;
}

}  // namespace stratum::assemble
