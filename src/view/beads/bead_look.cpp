#include "view/beads/bead_look.h"

#include "ondemand/print_attributes.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

constexpr int kLightSide = 32;
constexpr double kSurroundings = 0.06;  // share of the print's size within which surroundings darken
constexpr std::size_t kMaxColors = 65536;

template <typename Vector>
Json list(const Vector& v) {
    return Json::array({v.x, v.y, v.z});
}

Json tableOf(const shade::BareLight& light) {
    Json table = Json::array();
    const auto place = [](int n) { return 2.0F * static_cast<float>(n) / (kLightSide - 1) - 1.0F; };
    const auto rounded = [](float value) { return std::round(value * 1e4F) / 1e4; };
    for (int y = 0; y < kLightSide; ++y)
        for (int x = 0; x < kLightSide; ++x) {
            const glm::vec3 direction = shade::BareLight::unfolded(place(x), place(y));
            table.push_back(rounded(light.matt(direction)));
            table.push_back(rounded(light.gloss(direction)));
        }
    return table;
}

}  // namespace

Json cameraJson(const shade::Camera& camera) {
    return {{"eye", list(camera.eye())},
            {"forward", list(camera.forward())},
            {"up", list(camera.up())},
            {"right", list(camera.right())},
            {"fov", camera.fov()}};
}

Json lookOf(const ViewedPicture& picture, const PicturePlan& plan, const shade::BareLight* light) {
    const shade::SceneDescription& scene = picture.scene;
    const shade::ObjectMaterial only(scene.material);
    const shade::ObjectMaterial& material = scene.objects.empty() ? only : scene.objects.front();
    const trace::Box box = picture.print->bounds();
    const std::string& env = plan.options.scene.env;
    Json json{{"type", "look"},
              {"camera", cameraJson(scene.camera)},
              {"width", scene.camera.width()},
              {"height", scene.camera.height()},
              {"albedo", list(material.only().albedo)},
              {"exposure", picture.tone.exposure},
              {"follows", env == "studio" || env == "sky"},
              {"right", list(scene.camera.right())},
              {"reach", kSurroundings * glm::length(box.max - box.min)},
              {"bed", nullptr}};
    shade::Color horizon(0.0F), zenith(0.0F);
    if (scene.backdrop) {
        horizon = scene.backdrop->horizon;
        zenith = scene.backdrop->zenith;
    } else if (scene.environment->visible()) {
        horizon = scene.environment->radiance({0.0F, 1.0F, 0.0F});
        zenith = scene.environment->radiance({0.0F, 0.0F, 1.0F});
    }
    json["horizon"] = list(horizon);
    json["zenith"] = list(zenith);
    if (scene.bed)
        json["bed"] = {{"z", scene.bed->z},
                       {"albedo", list(scene.bed->texture.mean())},
                       {"center", {scene.bed->center.x, scene.bed->center.y}},
                       {"fade", {scene.bed->fade_begin, scene.bed->fade_end}},
                       {"grid", plan.options.scene.bed_surface == shade::BedSurface::grid}};
    if (light != nullptr) {
        json["light"] = tableOf(*light);
        json["brightest"] = light->brightest();
    }
    return json;
}

BeadColors colorsOf(const ViewedPicture& picture, const gcode::Toolpath& toolpath, const std::string& attribute) {
    const auto& objects = picture.scene.objects;
    if (objects.empty() || objects.front().single()) return {};
    const std::vector<voxelize::Attribute> wanted = voxelize::parseGrids(attribute);
    const voxelize::BeadAttributes values(toolpath, wanted);
    std::map<shade::Color, std::uint16_t, trace::Before> known;
    BeadColors colors;
    colors.places.reserve(toolpath.beads.size());
    for (std::uint32_t bead = 0; bead < toolpath.beads.size(); ++bead) {
        const glm::vec3 value = ondemand::valueOf(values, wanted.front(), bead);
        const shade::Color color = objects.front().of(value).albedo;
        const auto [found, fresh] = known.try_emplace(color, static_cast<std::uint16_t>(colors.palette.size()));
        if (fresh && colors.palette.size() < kMaxColors) {
            colors.palette.push_back(color);
            colors.values.push_back(value.x);
        }
        colors.places.push_back(found->second);
    }
    return colors;
}

}  // namespace stratum::view
