#include "view/asked/picture_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

namespace stratum::view {
namespace {

std::string vectorText(const glm::dvec3& v) { return fmt::format("{},{},{}", v.x, v.y, v.z); }

/// Options are set and said at once, so that the command line makes the same picture.
class Planner {
public:
    Planner(const GivenInput& given, const ViewState& state) : given_(given), state_(state) {
        plan_.options = given.options;
        plan_.exposure = given.options.exposure;
        plan_.legend = given.options.legend;
        plan_.words = {"vdbtrace", given.path};
        plan_.words.insert(plan_.words.end(), given.words.begin(), given.words.end());
    }

    PicturePlan plan() {
        selection();
        look();
        plan_.objects_key = said_;
        said_.clear();
        light();
        plan_.light_key = said_;
        picture();
        return std::move(plan_);
    }

private:
    void say(const char* option, const std::string& value = {}) {
        plan_.words.emplace_back(option);
        said_ += fmt::format("{} ", option);
        if (value.empty()) return;
        plan_.words.push_back(value);
        said_ += value + "\n";
    }

    void selection() {
        assemble::PrintRequest& prints = plan_.options.tracing.prints;
        if (state_.first_layer != 0 || state_.last_layer != 0) {
            prints.print.layers =
                fmt::format("{}:{}", std::max(1U, state_.first_layer),
                            state_.last_layer == 0 ? std::string() : std::to_string(state_.last_layer));
            say("--layers", prints.print.layers);
        }
        if (!state_.hidden_features.empty()) {
            prints.print.features.clear();
            for (const std::string& feature : state_.hidden_features)
                prints.print.features += fmt::format("{}-{}", prints.print.features.empty() ? "" : ",", feature);
            // With a dash in front the value would be taken for an option.
            say(fmt::format("--features={}", prints.print.features).c_str());
        }
        if (!state_.objects.empty()) prints.print.objects.clear();
        for (const std::uint32_t object : state_.objects) {
            prints.print.objects.push_back(std::to_string(object));
            say("--object", prints.print.objects.back());
        }
        if (!state_.tools.empty()) prints.print.tools = state_.tools;
        for (const std::uint8_t tool : state_.tools) say("--tool", std::to_string(tool));
        if (state_.printed) {
            prints.printed = fmt::format("{}{}%", state_.by_time ? "time:" : "", *state_.printed);
            say("--printed", prints.printed);
        }
        if (state_.beads) {
            prints.printed = fmt::format("bead:{}", *state_.beads);
            say("--printed", prints.printed);
        }
        if (state_.clip) {
            plan_.options.tracing.clip.push_back(*state_.clip);
            // The option replaces the planes of a scene, so that all are said.
            for (const trace::ClipPlane& plane : plan_.options.tracing.clip)
                say(fmt::format("--clip={},{}", vectorText(plane.normal), plane.offset).c_str());
        }
    }

    void look() {
        shade::SceneOptions& scene = plan_.options.scene;
        if (!state_.integrator.empty()) {
            plan_.options.render.integrator.name = state_.integrator;
            say("--integrator", state_.integrator);
        }
        if (!state_.color_by.empty()) {
            scene.color_by = state_.color_by;
            plan_.own_materials = false;
            say("--color-by", state_.color_by);
        }
        if (state_.color_range) {
            scene.color_range = state_.color_range;
            say(fmt::format("--color-range={},{}", (*state_.color_range)[0], (*state_.color_range)[1]).c_str());
        }
        if (!state_.material.empty()) {
            scene.brdf = state_.material;
            plan_.own_materials = false;
            say("--brdf", state_.material);
        }
        if (state_.smooth) {
            scene.smooth_normals = true;
            say("--normals", "smooth");
        }
    }

    void light() {
        shade::SceneOptions& scene = plan_.options.scene;
        if (!state_.light.empty()) {
            scene.env = state_.light;
            say("--env", state_.light);
            if (scene.env_exposure != 0.0) {
                scene.env_exposure = 0.0;  // of a map
                say("--env-exposure", "0");
                plan_.exposure = 0.0;  // as vdbtrace, after that option
            }
        }
        if (state_.light_rotation != 0.0) {
            scene.env_rotation = state_.light_rotation;
            say(fmt::format("--env-rotation={}", state_.light_rotation).c_str());
        }
        if (state_.bed && *state_.bed != scene.bed) {
            scene.bed = *state_.bed;
            say(*state_.bed ? "--bed" : "--no-bed");
        }
        if (state_.bed_surface && *state_.bed_surface != scene.bed_surface) {
            scene.bed_surface = *state_.bed_surface;
            say("--bed-surface", std::string(nameOf(shade::kBedSurfaces, scene.bed_surface)));
        }
        if (state_.exposure) {
            plan_.exposure = state_.exposure;
            say(fmt::format("--exposure={}", *state_.exposure).c_str());
        }
        plan_.options.find_exposure = !plan_.exposure;
    }

    void camera() {
        shade::CameraOptions& camera = plan_.options.scene.camera;
        if (state_.named) {
            camera.view = *state_.named;
            camera.eye.reset();
            camera.look_at.reset();
            camera.up.reset();
            say("--view", std::string(nameOf(shade::kViews, *state_.named)));
        }
        if (state_.eye) {
            camera.eye = state_.eye;
            camera.look_at = state_.look_at;
            camera.up.reset();
            say(fmt::format("--eye={}", vectorText(*state_.eye)).c_str());
            say(fmt::format("--look-at={}", vectorText(state_.look_at)).c_str());
        }
        if (state_.up) {
            camera.up = state_.up;
            say(fmt::format("--up={}", vectorText(*state_.up)).c_str());
        }
        if (camera.fov != state_.fov && (state_.named || state_.eye)) {
            camera.fov = state_.fov;
            say("--fov", fmt::format("{}", state_.fov));
        }
    }

    void picture() {
        camera();
        shade::RenderOptions& render = plan_.options.render;
        render.width = state_.width;
        render.height = state_.height;
        say("--size", fmt::format("{}x{}", state_.width, state_.height));
        if (render.crop) {  // of a scene; the page shows all of its picture
            render.crop.reset();
            say("--crop", fmt::format("0,0,{},{}", state_.width, state_.height));
        }
        if (!render.aovs.empty()) {
            render.aovs.clear();
            say("--aov");
            plan_.words.emplace_back();  // none
        }
        assemble::Denoising denoising = given_.options.denoising();
        if (state_.spp > 0) {
            render.spp = state_.spp;
            denoising.spp_given = true;
            say("--spp", std::to_string(state_.spp));
        }
        plan_.denoise = assemble::chooseDenoising(denoising, render);
    }

    const GivenInput& given_;
    const ViewState& state_;
    PicturePlan plan_;
    std::string said_;
};

}  // namespace

PicturePlan planPicture(const GivenInput& given, const ViewState& state) {
    PicturePlan plan = Planner(given, state).plan();
    plan.options.render.validate();
    plan.options.scene.camera.validate();
    return plan;
}

std::string shellLine(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) {
        const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) {
            return std::isalnum(c) != 0 ||
                   std::string_view("-_=+,.:/%@").find(static_cast<char>(c)) != std::string_view::npos;
        });
        if (!line.empty()) line += ' ';
        if (plain) {
            line += word;
            continue;
        }
        line += '\'';
        for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
        line += '\'';
    }
    return line;
}

}  // namespace stratum::view
