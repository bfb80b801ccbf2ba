#include "assemble/file/scene_file.h"

#include "assemble/file/object_file.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/json_section.h"
#include "shade/camera/camera_pose.h"
#include "shade/environment/environment.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace stratum::assemble {
namespace {

using Json = nlohmann::json;

/// Focus: a distance, or a point.
void readFocus(JsonSection& section, shade::CameraOptions& camera) {
    const Json* focus = section.find("focus");
    if (!focus) return;
    if (focus->is_number())
        camera.focus_distance = focus->get<double>();
    else
        section.read("focus", camera.focus_point);
}

/// A pose from matched points.
void readPhotograph(JsonSection section, shade::CameraOptions& camera, std::vector<std::string>& notes) {
    const auto size = section.numbers("size", 2);
    if (size.empty()) section.fail("size", "the photograph's width and height in pixels, [ ... ]");
    const Json* pairs = section.find("pairs");
    if (!pairs || !pairs->is_array()) section.fail("pairs", "a list of [pixel x, pixel y, X, Y, Z]");
    std::vector<shade::PointPair> points;
    for (const Json& pair : *pairs) {
        if (!pair.is_array() || pair.size() != 5 ||
            !std::all_of(pair.begin(), pair.end(), [](const Json& v) { return v.is_number(); }))
            section.fail(fmt::format("pairs[{}]", points.size()), "[pixel x, pixel y, X, Y, Z]");
        const auto v = pair.get<std::vector<double>>();
        points.push_back({{v[0], v[1]}, {v[2], v[3], v[4]}});
    }
    section.finish();
    const shade::CameraPose pose = shade::solveCameraPose(points, size[0], size[1]);
    camera.eye = pose.eye;
    camera.look_at = pose.eye + pose.forward;
    camera.up = pose.up;
    camera.fov = pose.fov;
    notes.push_back(fmt::format("camera from {} matched points: residual {:.3g} pixels RMS, worst {:.3g} at pair {}",
                                points.size(), pose.rms_pixels, pose.worst_pixels, pose.worst));
}

void readCamera(JsonSection section, shade::CameraOptions& camera, std::vector<std::string>& notes) {
    std::string view;
    section.read("view", view);
    if (!view.empty()) camera.view = shade::parseView(view);
    section.read("eye", camera.eye);
    section.read("look_at", camera.look_at);
    section.read("up", camera.up);
    section.read("fov", camera.fov);
    section.read("zoom", camera.zoom);
    section.read("aperture", camera.aperture);
    section.read("f_number", camera.f_number);
    readFocus(section, camera);
    if (auto photograph = section.section("photograph")) readPhotograph(std::move(*photograph), camera, notes);
    section.finish();
}

// The text of a scene; `name` is used in messages.
Json parseScene(const InputFile& input, const std::string& name) {
    constexpr std::size_t kMost = std::size_t{1} << 24;
    if (input.bytes().size() > kMost)
        throw InputError(fmt::format("{}: has {} bytes; a scene has at most {}", name, input.bytes().size(), kMost));
    try {
        // Comments are allowed: people explain their scenes.
        return Json::parse(input.bytes(), nullptr, true, true);
    } catch (const Json::exception& error) {
        throw InputError(fmt::format("{}: {}", name, error.what()));
    }
}

// What is traced.
void readShapes(JsonSection& top, const std::filesystem::path& folder, const std::string& name, SceneFile& file) {
    top.read("print", file.print);
    top.read("grid", file.grid);
    if (const Json* objects = top.find("objects")) {
        if (!file.print.empty() || !file.grid.empty())
            top.fail("objects", "to stand alone: print and grid are for scenes of one level set");
        if (!objects->is_array() || objects->empty()) top.fail("objects", "a list of objects, [ {...}, ... ]");
        for (const Json& object : *objects)
            file.objects.push_back(
                readObject(JsonSection(object, fmt::format("objects[{}]", file.objects.size()), name), folder));
    } else if (file.print.empty()) {
        top.fail("print", "the name of a level set, e.g. \"part.vdb\", or \"objects\": [ ... ]");
    } else {
        file.print = (folder / file.print).string();
    }
    file.file_up = readUp(top);
    if (!file.objects.empty() && !file.file_up.empty())
        top.fail("file_up", "to stand with the objects: each has its own");
}

void readPicture(JsonSection& top, SceneFile& file) {
    top.read("output", file.output);
    if (const auto size = top.numbers("size", 2); !size.empty()) {
        file.render.width = static_cast<int>(std::clamp(size[0], -1.0, 1e9));
        file.render.height = static_cast<int>(std::clamp(size[1], -1.0, 1e9));
    }
    if (const auto crop = top.numbers("crop", 4); !crop.empty()) {
        const auto at = [&](std::size_t i) { return static_cast<int>(std::clamp(crop[i], -1e9, 1e9)); };
        file.render.crop = shade::PixelBox{at(0), at(1), at(2), at(3)};
    }
    file.spp_given = top.find("spp") != nullptr;
    top.readInteger("spp", file.render.spp);
    top.readInteger("seed", file.render.seed);
    top.read("noise", file.render.noise);
    top.read("time", file.render.seconds);
    std::string checkpoint;
    top.read("checkpoint", checkpoint);
    file.render.checkpoint = checkpoint;
    if (bool denoise = false; top.find("denoise") != nullptr) {
        top.read("denoise", denoise);
        file.denoise = denoise;
    }
    file.exposure_given = top.find("exposure") != nullptr;
    top.read("exposure", file.tone.exposure);
    std::string aov;
    top.read("aov", aov);
    file.render.aovs = shade::parseAovs(aov);
}

// Environment and lamps.
void readLight(JsonSection& top, const std::filesystem::path& folder, const std::string& name, SceneFile& file) {
    if (const Json* environment = top.find("environment")) {
        JsonSection section(*environment, "environment", name);
        section.read("map", file.scene.env);
        section.read("rotation", file.scene.env_rotation);
        section.read("exposure", file.scene.env_exposure);
        file.exposure_given |= section.find("exposure") != nullptr;
        section.finish();
        if (!shade::isEnvironmentPreset(file.scene.env)) file.scene.env = beside(folder, file.scene.env);
    }
    if (const Json* lights = top.find("lights")) {
        if (!lights->is_array()) top.fail("lights", "a list of texts, as --light has them");
        for (const Json& light : *lights) {
            if (!light.is_string()) top.fail("lights", "texts, as --light has them");
            file.scene.lights.push_back(light.get<std::string>());
        }
    }
}

void readIntegrator(const Json& integrator, const std::string& name, shade::IntegratorOptions& options) {
    JsonSection section(integrator, "integrator", name);
    section.read("name", options.name);
    section.readInteger("bounces", options.bounces);
    section.read("ao_distance", options.ao_distance);
    section.read("exact_translucency", options.exact_translucency);
    if (const auto p = section.numbers("phong", 5); !p.empty()) {
        const auto at = [&](std::size_t i) { return static_cast<float>(p[i]); };
        options.phong = {at(0), at(1), at(2), at(3), at(4)};
    }
    section.finish();
}

}  // namespace

bool isSceneFile(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text[first] == '{';
}

SceneFile readSceneFile(const std::filesystem::path& path) {
    const InputFile input(path);
    const std::string name = path.string();
    const Json json = parseScene(input, name);
    const std::filesystem::path folder = path.parent_path();
    SceneFile file;
    JsonSection top(json, "", name);
    readShapes(top, folder, name, file);
    top.read("color_by", file.scene.color_by);
    file.scene.color_range = readColorRange(top, file.scene.color_by);
    std::string normals = "geometric";
    top.read("normals", normals);
    if (normals != "geometric" && normals != "smooth") top.fail("normals", "geometric or smooth");
    file.scene.smooth_normals = normals == "smooth";
    readPicture(top, file);
    top.read("material", file.scene.brdf);
    file.scene.brdf = materialBeside(folder, file.scene.brdf);
    top.read("bed", file.scene.bed);
    std::string surface;
    top.read("bed_surface", surface);
    if (!surface.empty()) file.scene.bed_surface = shade::parseBedSurface(surface);
    std::string background = "scene";
    top.read("background", background);
    if (background != "scene" && background != "none") top.fail("background", "scene or none");
    file.scene.transparent = background == "none";
    if (auto camera = top.section("camera")) readCamera(std::move(*camera), file.scene.camera, file.notes);
    readLight(top, folder, name, file);
    if (const Json* integrator = top.find("integrator")) readIntegrator(*integrator, name, file.render.integrator);
    top.finish();
    return file;
}

}  // namespace stratum::assemble
