#include "assemble/scene_file.h"

#include "assemble/file/object_file.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/options/json_section.h"
#include "shade/camera/camera_pose.h"
#include "shade/environment/environment.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

using Json = nlohmann::json;

// The options of a picture, of which some have sections of their own, or other names.
class SceneOptionSource final : public OptionSource {
public:
    /// @param camera  and the others: null where the scene has no such section
    SceneOptionSource(JsonSection& top, JsonSection* camera, JsonSection* environment, JsonSection* integrator)
        : sections_{&top, camera, environment, integrator} {}

    std::optional<double> number(std::string_view name) override {
        return ask(name, [](JsonSection& section, std::string_view key) { return section.number(key); });
    }
    std::optional<std::int64_t> integer(std::string_view name, std::int64_t least, std::int64_t most) override {
        return ask(name, [=](JsonSection& section, std::string_view key) { return section.integer(key, least, most); });
    }
    std::optional<bool> flag(std::string_view name) override {
        return ask(name, [](JsonSection& section, std::string_view key) { return section.flag(key); });
    }
    std::optional<std::string> text(std::string_view name) override {
        return ask(name, [](JsonSection& section, std::string_view key) { return section.text(key); });
    }
    std::vector<double> list(std::string_view name, char /*separator*/) override {
        return ask(name, [](JsonSection& section, std::string_view key) { return section.list(key); });
    }
    std::vector<std::string> texts(std::string_view name) override {
        return ask(name, [](JsonSection& section, std::string_view key) { return section.texts(key); });
    }
    bool says(std::string_view name, std::string_view word) override {
        return ask(name, [=](JsonSection& section, std::string_view key) { return section.says(key, word); });
    }
    bool given(std::string_view name) const override {
        const Place place = placeOf(name);
        return sections_[place.section] != nullptr && sections_[place.section]->given(place.key);
    }
    std::string called(std::string_view name) const override {
        const Place place = placeOf(name);
        return sections_[place.section]->called(place.key);
    }
    [[noreturn]] void fail(std::string_view name, std::string_view expected) const override {
        const Place place = placeOf(name);
        sections_[place.section]->fail(place.key, expected);
    }
    [[noreturn]] void refuse(std::string_view name, std::string_view expected) const override { fail(name, expected); }

private:
    enum Section : std::size_t { kTop, kCamera, kEnvironment, kIntegrator, kSections };
    struct Place {
        Section section = kTop;
        std::string_view key;
    };

    static Place placeOf(std::string_view name) {
        // What is called otherwise here than in Python.
        static constexpr Names<Place, 6> kOthers = {{{"seconds", {kTop, "time"}},
                                                     {"brdf", {kTop, "material"}},
                                                     {"env", {kEnvironment, "map"}},
                                                     {"env_rotation", {kEnvironment, "rotation"}},
                                                     {"env_exposure", {kEnvironment, "exposure"}},
                                                     {"integrator", {kIntegrator, "name"}}}};
        if (const auto place = valueOf(kOthers, name)) return *place;
        const auto isOneOf = [name](std::initializer_list<std::string_view> names) {
            return std::find(names.begin(), names.end(), name) != names.end();
        };
        if (isOneOf({"view", "eye", "look_at", "up", "fov", "zoom", "aperture", "f_number", "focus", "frame",
                     "photograph"}))
            return {kCamera, name};
        if (isOneOf({"bounces", "phong", "ao_distance", "exact_translucency"})) return {kIntegrator, name};
        return {kTop, name};
    }

    template <typename Ask>
    auto ask(std::string_view name, const Ask& ask) -> decltype(ask(std::declval<JsonSection&>(), name)) {
        const Place place = placeOf(name);
        if (sections_[place.section] == nullptr) return {};
        return ask(*sections_[place.section], place.key);
    }

    std::array<JsonSection*, kSections> sections_;
};

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

// The objects and lists that a parser is in. It keeps the last of two equal keys, and would not say so.
class OpenPlaces {
public:
    /// False for a key that its object has already.
    bool add(Json::parse_event_t event, const Json& value) {
        using Event = Json::parse_event_t;
        if (event == Event::object_end || event == Event::array_end) {
            places_.pop_back();
            return true;
        }
        if (event == Event::key) {
            places_.back().key = value.get<std::string>();
            return places_.back().keys.insert(places_.back().key).second;
        }
        if (!places_.empty()) ++places_.back().begun;
        if (event != Event::value) places_.push_back({event == Event::array_start, 0, {}, {}});
        return true;
    }

    /// As JsonSection names places: "objects[2].transform.scale".
    std::string path() const {
        std::string path;
        for (const Place& place : places_)
            path += place.list ? fmt::format("[{}]", place.begun - 1) : (path.empty() ? "" : ".") + place.key;
        return path;
    }

private:
    struct Place {
        bool list = false;
        std::size_t begun = 0;       // elements
        std::string key;             // the last one of an object
        std::set<std::string> keys;  // all of them
    };
    std::vector<Place> places_;
};

// The text of a scene; `name` is used in messages.
Json parseScene(const InputFile& input, const std::string& name) {
    constexpr std::size_t kMost = std::size_t{1} << 24;
    if (input.bytes().size() > kMost)
        throw InputError(fmt::format("{}: has {} bytes; a scene has at most {}", name, input.bytes().size(), kMost));
    try {
        OpenPlaces places;
        const auto refuseTwice = [&](int, Json::parse_event_t event, Json& value) {
            if (!places.add(event, value))
                throw InputError(fmt::format("{}: {} is there twice; keep one", name, places.path()));
            return true;
        };
        // Comments are allowed: people explain their scenes.
        return Json::parse(input.bytes(), refuseTwice, true, true);
    } catch (const Json::exception& error) {
        throw InputError(fmt::format("{}: {}", name, error.what()));
    }
}

// What is traced.
void readShapes(JsonSection& top, const std::filesystem::path& folder, const std::string& name, SceneFile& file) {
    top.read("print", file.print);
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
    if (!file.objects.empty() && !file.file_up.empty())
        top.fail("file_up", "to stand with the objects: each has its own");
}

}  // namespace

bool isSceneFile(std::string_view text) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark of Windows' editors
    while (true) {
        text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
        const std::string_view end = text.starts_with("//") ? "\n" : text.starts_with("/*") ? "*/" : "";
        if (end.empty()) return text.starts_with('{');
        const std::size_t stop = text.find(end, 2);
        text.remove_prefix(stop == std::string_view::npos ? text.size() : stop + end.size());
    }
}

SceneFile readSceneFile(const std::filesystem::path& path) {
    const InputFile input(path);
    const std::string name = path.string();
    const Json json = parseScene(input, name);
    const std::filesystem::path folder = path.parent_path();
    SceneFile file;
    JsonSection top(json, "", name);
    auto camera = top.section("camera");
    auto environment = top.section("environment");
    auto integrator = top.section("integrator");
    const auto there = [](std::optional<JsonSection>& section) { return section ? &*section : nullptr; };
    SceneOptionSource options(top, there(camera), there(environment), there(integrator));
    readPicture(options, file);
    tellOfUnused(options, file);
    readShapes(top, folder, name, file);
    top.read("output", file.output);
    std::string checkpoint;
    top.read("checkpoint", checkpoint);
    file.render.checkpoint = checkpoint;
    file.scene.brdf = materialBeside(folder, file.scene.brdf);
    if (!shade::isEnvironmentPreset(file.scene.env)) file.scene.env = beside(folder, file.scene.env);
    if (camera)
        if (auto photograph = camera->section("photograph")) {
            readPhotograph(std::move(*photograph), file.scene.camera, file.notes);
            file.photograph = true;
        }
    for (const JsonSection* section : {&top, there(camera), there(environment), there(integrator)})
        if (section != nullptr) section->finish();
    return file;
}

}  // namespace stratum::assemble
