#include "shade/scene_file.h"

#include "io/error.h"
#include "io/mapped_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>

namespace stratum::shade {
namespace {

using Json = nlohmann::json;

/// Levenshtein's distance: single letters inserted, removed or replaced.
std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t above = row[j];
            row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
            diagonal = above;
        }
    }
    return row.back();
}

/// One object of the file. Every key that is asked for is known; finish() refuses all others.
class Section {
public:
    Section(const Json& json, std::string path, const std::string& file)
        : json_(json), path_(std::move(path)), file_(file) {
        if (!json.is_object()) fail("", "an object, { ... }");
    }

    const Json* find(const char* key) {
        known_.emplace_back(key);
        const auto found = json_.find(key);
        return found == json_.end() ? nullptr : &*found;
    }
    void read(const char* key, std::string& value) {
        if (const Json* j = find(key)) {
            if (!j->is_string()) fail(key, "a text");
            value = j->get<std::string>();
        }
    }
    void read(const char* key, bool& value) {
        if (const Json* j = find(key)) {
            if (!j->is_boolean()) fail(key, "true or false");
            value = j->get<bool>();
        }
    }
    void read(const char* key, double& value) {
        if (const Json* j = find(key)) {
            if (!j->is_number()) fail(key, "a number");
            value = j->get<double>();
        }
    }
    template <typename Integer>
    void readInteger(const char* key, Integer& value) {
        if (const Json* j = find(key)) {
            constexpr auto kMost = static_cast<double>(std::numeric_limits<Integer>::max());
            if (!j->is_number_integer() || !(j->get<double>() >= 0.0 && j->get<double>() <= kMost))
                fail(key, "a whole number, not negative");
            value = j->get<Integer>();
        }
    }
    /// Exactly `count` numbers; empty if the key is not there.
    std::vector<double> numbers(const char* key, std::size_t count) {
        const Json* j = find(key);
        if (!j) return {};
        const bool good = j->is_array() && j->size() == count &&
                          std::all_of(j->begin(), j->end(), [](const Json& v) { return v.is_number(); });
        if (!good) fail(key, fmt::format("{} numbers, [ ... ]", count));
        return j->get<std::vector<double>>();
    }
    void read(const char* key, std::optional<glm::dvec3>& value) {
        if (const auto v = numbers(key, 3); !v.empty()) value = glm::dvec3(v[0], v[1], v[2]);
    }
    /// Throws for keys that nobody asked for.
    void finish() const {
        for (const auto& item : json_.items()) {
            if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
            const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
                return editDistance(a, item.key()) < editDistance(b, item.key());
            });
            throw InputError(
                fmt::format("{}: {}: unknown key; did you mean '{}'?", file_, place(item.key()), *nearest));
        }
    }
    std::string place(std::string_view key) const {
        return path_.empty() ? std::string(key) : key.empty() ? path_ : fmt::format("{}.{}", path_, key);
    }
    [[noreturn]] void fail(std::string_view key, std::string_view expected) const {
        const std::string where = place(key);
        throw InputError(fmt::format("{}: {}: expected {}", file_, where.empty() ? "the file" : where, expected));
    }

private:
    const Json& json_;
    std::string path_;
    const std::string& file_;
    std::vector<std::string> known_;
};

void readCamera(Section section, CameraOptions& camera) {
    std::string view;
    section.read("view", view);
    if (!view.empty()) camera.view = parseView(view);
    section.read("eye", camera.eye);
    section.read("look_at", camera.look_at);
    section.read("up", camera.up);
    section.read("fov", camera.fov);
    section.finish();
}

/// A file beside the scene, if there is one of that name; else the text is a preset.
std::string beside(const std::filesystem::path& folder, const std::string& text) {
    std::error_code error;
    const std::filesystem::path path = folder / text;
    return !text.empty() && std::filesystem::is_regular_file(path, error) ? path.string() : text;
}

}  // namespace

bool isSceneFile(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && text[first] == '{';
}

SceneFile readSceneFile(const std::filesystem::path& path) {
    constexpr std::size_t kMost = std::size_t{1} << 24;
    const MappedFile mapped(path);
    const std::string name = path.string();
    if (mapped.bytes().size() > kMost)
        throw InputError(fmt::format("{}: has {} bytes; a scene has at most {}", name, mapped.bytes().size(), kMost));
    Json json;
    try {
        // Comments are allowed: people explain their scenes.
        json = Json::parse(mapped.bytes(), nullptr, true, true);
    } catch (const Json::exception& error) {
        throw InputError(fmt::format("{}: {}", name, error.what()));
    }
    const std::filesystem::path folder = path.parent_path();
    SceneFile file;
    Section top(json, "", name);
    top.read("print", file.print);
    if (file.print.empty()) top.fail("print", "the name of a level set, e.g. \"part.vdb\"");
    file.print = (folder / file.print).string();
    top.read("grid", file.grid);
    top.read("output", file.output);
    if (const auto size = top.numbers("size", 2); !size.empty()) {
        file.render.width = static_cast<int>(std::clamp(size[0], -1.0, 1e9));
        file.render.height = static_cast<int>(std::clamp(size[1], -1.0, 1e9));
    }
    if (const auto crop = top.numbers("crop", 4); !crop.empty()) {
        const auto at = [&](std::size_t i) { return static_cast<int>(std::clamp(crop[i], -1e9, 1e9)); };
        file.render.crop = PixelBox{at(0), at(1), at(2), at(3)};
    }
    file.spp_given = top.find("spp") != nullptr;
    top.readInteger("spp", file.render.spp);
    top.readInteger("seed", file.render.seed);
    top.read("noise", file.render.noise);
    top.read("exposure", file.tone.exposure);
    std::string aov;
    top.read("aov", aov);
    file.render.aovs = parseAovs(aov);
    top.read("material", file.scene.brdf);
    file.scene.brdf = beside(folder, file.scene.brdf);
    top.read("bed", file.scene.bed);
    if (const Json* camera = top.find("camera")) readCamera(Section(*camera, "camera", name), file.scene.camera);
    if (const Json* environment = top.find("environment")) {
        Section section(*environment, "environment", name);
        section.read("map", file.scene.env);
        section.read("rotation", file.scene.env_rotation);
        section.read("exposure", file.scene.env_exposure);
        section.finish();
        file.scene.env = beside(folder, file.scene.env);
    }
    if (const Json* lights = top.find("lights")) {
        if (!lights->is_array()) top.fail("lights", "a list of texts, as --light has them");
        for (const Json& light : *lights) {
            if (!light.is_string()) top.fail("lights", "texts, as --light has them");
            file.scene.lights.push_back(light.get<std::string>());
        }
    }
    if (const Json* integrator = top.find("integrator")) {
        Section section(*integrator, "integrator", name);
        section.read("name", file.render.integrator.name);
        section.readInteger("bounces", file.render.integrator.bounces);
        section.read("ao_distance", file.render.integrator.ao_distance);
        section.readInteger("environment_rows", file.render.integrator.environment_rows);
        if (const auto p = section.numbers("phong", 5); !p.empty()) {
            const auto at = [&](std::size_t i) { return static_cast<float>(p[i]); };
            file.render.integrator.phong = {at(0), at(1), at(2), at(3), at(4)};
        }
        section.finish();
    }
    top.finish();
    return file;
}

}  // namespace stratum::shade
