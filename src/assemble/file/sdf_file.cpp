#include "assemble/file/sdf_file.h"

#include "base/error.h"
#include "base/options/json_section.h"
#include "trace/scene_intersector.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

namespace stratum::assemble {
namespace {

using Json = nlohmann::json;
using trace::SdfPtr;

constexpr int kDeepest = 64;  // shapes within shapes
// Repetitions within repetitions: each asks its part eight times for a distance.
constexpr int kMostRepetitions = 4;

struct Depth {
    int shapes = 0, repetitions = 0;
};

SdfPtr read(const Json& json, const std::string& path, const std::string& file, Depth depth);

/// Required keys.
double need(JsonSection& s, const char* key) {
    double value = std::nan("");
    s.read(key, value);
    if (std::isnan(value)) s.fail(key, "a number");
    return value;
}

glm::dvec3 needVector(JsonSection& s, const char* key) {
    const auto v = s.numbers(key, 3);
    if (v.empty()) s.fail(key, "3 numbers, [ ... ]");
    return {v[0], v[1], v[2]};
}

glm::dvec3 center(JsonSection& s) {
    glm::dvec3 value(0.0);
    s.read("center", value);
    return value;
}

int axis(JsonSection& s) {
    std::string name = "z";
    s.read("axis", name);
    if (name != "x" && name != "y" && name != "z") s.fail("axis", "x, y or z");
    return name[0] - 'x';
}

SdfPtr readOf(JsonSection& s, Depth depth) {
    const Json* of = s.find("of");
    if (!of) s.fail("of", "the shape, { ... }");
    ++depth.shapes;
    return read(*of, s.place("of"), s.file(), depth);
}

SdfPtr readShape(const std::string& kind, JsonSection& s, Depth depth) {
    if (kind == "sphere") return trace::sdfSphere(center(s), need(s, "radius"));
    if (kind == "box") return trace::sdfBox(center(s), needVector(s, "half_extents"));
    if (kind == "torus") return trace::sdfTorus(center(s), need(s, "radius"), need(s, "tube"), axis(s));
    if (kind == "cylinder") return trace::sdfCylinder(center(s), need(s, "radius"), need(s, "half_height"), axis(s));
    if (kind == "plane") {
        double offset = 0.0;
        s.read("offset", offset);
        return trace::sdfPlane(needVector(s, "normal"), offset);
    }
    if (kind == "move") {
        glm::dvec3 rotate(0.0);
        glm::dvec3 translate(0.0);
        s.read("rotate", rotate);
        s.read("translate", translate);
        const auto placement = trace::Placement::of(glm::dvec3(1.0), rotate, translate);
        return trace::sdfMoved(readOf(s, depth), placement.linear, placement.offset);
    }
    const glm::dvec3 period = needVector(s, "period");
    int count = -1;
    s.readInteger("count", count);
    if (++depth.repetitions > kMostRepetitions)
        s.fail("", fmt::format("no more than {} repetitions within each other", kMostRepetitions));
    return trace::sdfRepetition(readOf(s, depth), period, count);
}

SdfPtr read(const Json& json, const std::string& path, const std::string& file, Depth depth) {
    JsonSection section(json, path, file);
    if (json.size() != 1) section.fail("", "one shape or operation, { \"sphere\": { ... } }");
    if (depth.shapes > kDeepest) section.fail("", fmt::format("no more than {} shapes within each other", kDeepest));
    const Depth within{depth.shapes + 1, depth.repetitions};
    try {
        for (const char* kind : {"union", "intersection", "subtraction"}) {
            const Json* list = section.find(kind);
            if (!list) continue;
            if (!list->is_array() || list->empty()) section.fail(kind, "a list of shapes, [ {...}, ... ]");
            std::vector<SdfPtr> parts;
            for (const Json& part : *list)
                parts.push_back(read(part, fmt::format("{}[{}]", section.place(kind), parts.size()), file, within));
            if (*kind == 'u') return trace::sdfUnion(std::move(parts));
            return *kind == 'i' ? trace::sdfIntersection(std::move(parts)) : trace::sdfSubtraction(std::move(parts));
        }
        for (const char* kind : {"sphere", "box", "torus", "cylinder", "plane", "move", "repeat"}) {
            auto inner = section.section(kind);
            if (!inner) continue;
            SdfPtr shape = readShape(kind, *inner, depth);
            inner->finish();
            return shape;
        }
        section.finish();
    } catch (const UsageError& error) {
        throw InputError(fmt::format("{}: {}: {}", file, path, error.what()));
    }
    return nullptr;  // not reached: finish() refuses the one unknown key
}

}  // namespace

trace::SdfPtr readSdf(const nlohmann::json& json, const std::string& path, const std::string& file) {
    return read(json, path, file, {});
}

}  // namespace stratum::assemble
