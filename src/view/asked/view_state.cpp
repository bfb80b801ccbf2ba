#include "view/asked/view_state.h"

#include "assemble/file/object_file.h"
#include "base/error.h"
#include "base/options/json_section.h"
#include "gcode/toolpath/toolpath.h"
#include "shade/finish/named_brdf.h"
#include "shade/integrator/integrator.h"
#include "shade/palette/filament_color.h"
#include "voxelize/grid/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

constexpr int kLeastSide = 16, kMostSide = 8192;
constexpr double kMostPixels = 40e6;
constexpr double kMostLength = 1e7;  // world units
constexpr double kMostBeads = 4294967295.0;
constexpr std::size_t kMostText = 200, kMostNumbers = 1000;

// Lists of the JSON, with their sizes bounded.
const Json* listOf(JsonSection& section, const char* key) {
    const Json* list = section.find(key);
    if (list == nullptr) return nullptr;
    if (!list->is_array() || list->size() > kMostNumbers) section.fail(key, "a short list");
    return list;
}

template <typename Integer>
void readNumbers(JsonSection& section, const char* key, std::vector<Integer>& values, Integer most) {
    const Json* list = listOf(section, key);
    if (list == nullptr) return;
    for (const Json& value : *list) {
        if (!value.is_number_unsigned() || value.get<std::uint64_t>() > most) section.fail(key, "whole numbers");
        values.push_back(value.get<Integer>());
    }
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

double boundedNumber(JsonSection& section, const char* key, double least, double most, double fallback) {
    double value = fallback;
    section.read(key, value);
    if (!(value >= least && value <= most)) section.fail(key, fmt::format("a number from {:g} to {:g}", least, most));
    return value;
}

std::optional<double> optionalNumber(JsonSection& section, const char* key, double least, double most) {
    if (section.find(key) == nullptr) return std::nullopt;
    return boundedNumber(section, key, least, most, least);
}

std::optional<glm::dvec3> point(JsonSection& section, const char* key) {
    std::optional<glm::dvec3> value;
    section.read(key, value);
    if (value && !(std::max({std::abs(value->x), std::abs(value->y), std::abs(value->z)}) <= kMostLength))
        section.fail(key, "coordinates of a printer");
    return value;
}

std::string text(JsonSection& section, const char* key) {
    std::string value;
    section.read(key, value);
    if (value.size() > kMostText) section.fail(key, "a short text");
    return value;
}

void readCamera(JsonSection section, ViewState& state) {
    const std::string view = text(section, "view");
    state.named = valueOf(shade::kViews, view);
    if (!state.named && !view.empty()) section.fail("view", "iso, front, back, left, right, top or bottom");
    state.eye = point(section, "eye");
    const std::optional<glm::dvec3> look_at = point(section, "look_at");
    if (state.eye.has_value() != look_at.has_value()) section.fail("eye", "a point, together with look_at");
    if (state.eye && state.named) section.fail("eye", "a point or a view, not both");
    if (look_at) state.look_at = *look_at;
    state.up = point(section, "up");
    state.fov = boundedNumber(section, "fov", 1.0, 120.0, state.fov);
    section.finish();
}

void readSelection(JsonSection& section, ViewState& state) {
    if (const std::vector<double> layers = section.numbers("layers", 2); !layers.empty()) {
        for (const double layer : layers)
            if (!(layer >= 0 && layer <= 1e9 && layer == std::floor(layer)))
                section.fail("layers", "two whole numbers");
        state.first_layer = static_cast<std::uint32_t>(layers[0]);
        state.last_layer = static_cast<std::uint32_t>(layers[1]);
        if (state.last_layer != 0 && state.first_layer > state.last_layer)
            section.fail("layers", "the lower layer first");
    }
    state.printed = optionalNumber(section, "printed", 1e-6, 100.0);
    if (state.printed == 100.0) state.printed.reset();
    if (const auto beads = optionalNumber(section, "beads", 1, kMostBeads)) {
        if (*beads != std::floor(*beads)) section.fail("beads", "a whole number");
        if (state.printed) section.fail("beads", "nothing beside printed: a share or a number of beads");
        state.beads = static_cast<std::uint32_t>(*beads);
    }
    section.read("by_time", state.by_time);
    if (const Json* features = listOf(section, "hidden_features"))
        for (const Json& feature : *features) {
            if (!feature.is_string() || gcode::featureNamed(feature.get<std::string>()) == gcode::Feature::count_)
                section.fail("hidden_features", "names of features");
            state.hidden_features.push_back(feature.get<std::string>());
        }
    readNumbers<std::uint32_t>(section, "objects", state.objects, 65535);
    readNumbers<std::uint8_t>(section, "tools", state.tools, 255);
}

// Text that shade::makeBrdf() takes without opening a file that the page has named.
bool namesMaterial(const std::string& text) {
    return shade::isBrdfPreset(text) || shade::parseNamedColor(text).has_value();
}

// The same of shade::makeEnvironment().
bool namesLight(const std::string& text) {
    return text == "studio" || text == "sky" || text.starts_with("sky:") || text.starts_with("constant:");
}

void readLook(JsonSection& section, ViewState& state) {
    state.color_by = text(section, "color_by");
    if (!state.color_by.empty()) {
        try {
            if (voxelize::parseGrids(state.color_by).size() != 1) section.fail("color_by", "an attribute");
        } catch (const UsageError&) {
            section.fail("color_by", "an attribute");
        }
    }
    state.color_range = assemble::readColorRange(section, state.color_by);
    state.material = text(section, "material");
    if (!state.material.empty() && !namesMaterial(state.material))
        section.fail("material",
                     "a colour, lambert:R,G,B, plastic:R,G,B,ALPHA, metal:R,G,B,ALPHA, "
                     "translucent:R,G,B,MEAN_FREE_PATH_MM or a material by its name");
    state.light = text(section, "light");
    if (!state.light.empty() && !namesLight(state.light))
        section.fail("light", "studio, sky, sky:ELEVATION,AZIMUTH or constant:R,G,B");
    state.light_rotation = boundedNumber(section, "light_rotation", -360.0, 360.0, 0.0);
    state.exposure = optionalNumber(section, "exposure", -20.0, 20.0);
    if (section.find("bed") != nullptr) {
        bool bed = true;
        section.read("bed", bed);
        state.bed = bed;
    }
    const std::string surface = text(section, "bed_surface");
    state.bed_surface = valueOf(shade::kBedSurfaces, surface);
    if (!state.bed_surface && !surface.empty()) section.fail("bed_surface", "paper, pei or grid");
    section.read("smooth", state.smooth);
    if (const std::vector<double> clip = section.numbers("clip", 4); !clip.empty()) {
        state.clip = trace::ClipPlane{{clip[0], clip[1], clip[2]}, clip[3]};
        const double length = std::abs(clip[0]) + std::abs(clip[1]) + std::abs(clip[2]);
        if (!(length > 1e-6 && length < 1e6 && std::abs(clip[3]) < kMostLength * length))
            section.fail("clip", "a normal, not zero, and an offset");
    }
    state.integrator = text(section, "integrator");
    if (!state.integrator.empty()) {
        shade::IntegratorOptions options;
        options.name = state.integrator;
        try {
            options.validate();
        } catch (const UsageError&) {
            section.fail("integrator", "path, direct, ao, normal or another of vdbtrace's");
        }
    }
    state.spp = static_cast<int>(boundedNumber(section, "spp", 0.0, 1024.0, 0.0));
}

}  // namespace

bool ViewState::operator==(const ViewState& other) const { return toJson(*this) == toJson(other); }

ViewState parseViewState(const Json& json) {
    static const std::string name = "the view";
    JsonSection section(json, "", name);
    ViewState state;
    if (const std::vector<double> size = section.numbers("size", 2); !size.empty()) {
        for (const double side : size)
            if (!(side >= kLeastSide && side <= kMostSide && side == std::floor(side)))
                section.fail("size", fmt::format("two whole numbers from {} to {}", kLeastSide, kMostSide));
        if (size[0] * size[1] > kMostPixels) section.fail("size", "at most 40 million pixels");
        state.width = static_cast<int>(size[0]);
        state.height = static_cast<int>(size[1]);
    }
    if (auto camera = section.section("camera")) readCamera(std::move(*camera), state);
    readSelection(section, state);
    readLook(section, state);
    section.finish();
    return state;
}

Json toJson(const ViewState& state) {
    const auto list = [](const glm::dvec3& v) { return Json::array({v.x, v.y, v.z}); };
    Json camera{{"fov", state.fov}};
    if (state.named) camera["view"] = nameOf(shade::kViews, *state.named);
    if (state.eye) {
        camera["eye"] = list(*state.eye);
        camera["look_at"] = list(state.look_at);
    }
    if (state.up) camera["up"] = list(*state.up);
    Json json{{"size", {state.width, state.height}},
              {"camera", std::move(camera)},
              {"layers", {state.first_layer, state.last_layer}},
              {"by_time", state.by_time},
              {"hidden_features", state.hidden_features},
              {"objects", state.objects},
              {"tools", state.tools},
              {"color_by", state.color_by},
              {"material", state.material},
              {"light", state.light},
              {"light_rotation", state.light_rotation},
              {"smooth", state.smooth},
              {"integrator", state.integrator},
              {"spp", state.spp}};
    if (state.printed) json["printed"] = *state.printed;
    if (state.beads) json["beads"] = *state.beads;
    if (state.color_range) json["color_range"] = *state.color_range;
    if (state.exposure) json["exposure"] = *state.exposure;
    if (state.bed) json["bed"] = *state.bed;
    if (state.bed_surface) json["bed_surface"] = nameOf(shade::kBedSurfaces, *state.bed_surface);
    if (state.clip) {
        json["clip"] = list(state.clip->normal);
        json["clip"].push_back(state.clip->offset);
    }
    return json;
}

}  // namespace stratum::view
