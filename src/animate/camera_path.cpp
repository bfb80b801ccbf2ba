#include "animate/camera_path.h"

#include "base/error.h"
#include "base/input_file.h"
#include "base/json_section.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>

namespace stratum::animate {
namespace {

using Json = nlohmann::json;

// What lies beyond would make no picture, and its differences no number.
constexpr double kLatest = 1e7;      // s
constexpr double kFarthest = 1e9;    // units of the world
constexpr double kLeastStep = 1e-6;  // s, from one key to the next

bool isNear(const glm::dvec3& p) {
    return std::abs(p.x) <= kFarthest && std::abs(p.y) <= kFarthest && std::abs(p.z) <= kFarthest;
}

CameraKey readKey(const Json& json, const std::string& place, const std::string& file) {
    JsonSection section(json, place, file);
    CameraKey key;
    key.time = std::numeric_limits<double>::quiet_NaN();
    section.read("time", key.time);
    std::optional<glm::dvec3> eye;
    section.read("eye", eye);
    section.read("look_at", key.look_at);
    section.read("up", key.up);
    double fov = std::numeric_limits<double>::quiet_NaN();
    section.read("fov", fov);
    section.finish();
    if (!(std::abs(key.time) <= kLatest))
        section.fail("time", "a number of at most 1e7, the seconds from the film's begin");
    if (!eye || !isNear(*eye)) section.fail("eye", "3 numbers of at most 1e9, [ ... ]: where the camera stands");
    if (key.look_at && !isNear(*key.look_at)) section.fail("look_at", "3 numbers of at most 1e9, [ ... ]");
    if (key.up && !isNear(*key.up)) section.fail("up", "3 numbers of at most 1e9, [ ... ]");
    key.eye = *eye;
    if (std::isnan(fov)) return key;
    if (!(fov > 0.0 && fov <= 170.0)) section.fail("fov", "an angle above 0 and at most 170 degrees");
    key.fov = fov;
    return key;
}

std::array<MonotoneCubic, 3> wayOf(const std::vector<CameraKey>& keys,
                                   const std::function<glm::dvec3(const CameraKey&)>& point) {
    std::vector<double> times;
    std::array<std::vector<double>, 3> values;
    times.reserve(keys.size());
    for (const CameraKey& key : keys) {
        times.push_back(key.time);
        const glm::dvec3 p = point(key);
        for (int axis = 0; axis < 3; ++axis) values[static_cast<std::size_t>(axis)].push_back(p[axis]);
    }
    return {MonotoneCubic(times, values[0]), MonotoneCubic(times, values[1]), MonotoneCubic(times, values[2])};
}

MonotoneCubic fovOf(const std::vector<CameraKey>& keys, double usual) {
    std::vector<double> times;
    std::vector<double> angles;
    times.reserve(keys.size());
    angles.reserve(keys.size());
    for (const CameraKey& key : keys) {
        times.push_back(key.time);
        angles.push_back(key.fov.value_or(usual));
    }
    return {std::move(times), std::move(angles)};
}

}  // namespace

std::vector<CameraKey> readCameraKeys(const std::filesystem::path& path) {
    const InputFile bytes(path);
    const std::string file = path.string();
    Json json;
    try {
        json = Json::parse(bytes.bytes());
    } catch (const Json::exception& error) {
        throw InputError(fmt::format("{}: is no JSON ({})", file, error.what()));
    }
    JsonSection section(json, "", file);
    const Json* list = section.find("keys");
    section.finish();
    constexpr std::size_t kFewest = 2;
    constexpr std::size_t kMost = 100000;
    if (!list || !list->is_array() || list->size() < kFewest || list->size() > kMost)
        section.fail("keys", "a list of two or more, [ {\"time\": 0, \"eye\": [x, y, z]}, ... ]");
    std::vector<CameraKey> keys;
    keys.reserve(list->size());
    for (const Json& json_key : *list) {
        const std::string place = fmt::format("keys[{}]", keys.size());
        keys.push_back(readKey(json_key, place, file));
        if (keys.size() > 1 && !(keys.back().time >= keys[keys.size() - 2].time + kLeastStep))
            throw InputError(fmt::format(
                "{}: {}.time: is {:g}, and the key before has {:g}; sort the keys by time, a microsecond apart at "
                "least",
                file, place, keys.back().time, keys[keys.size() - 2].time));
    }
    return keys;
}

double durationOf(const std::vector<CameraKey>& keys) { return keys.back().time - keys.front().time; }

void placeAt(const CameraKey& key, shade::CameraOptions& options) {
    options.eye = key.eye;
    if (key.look_at) options.look_at = key.look_at;
    if (key.up) options.up = key.up;
    if (key.fov) options.fov = *key.fov;
}

CameraPath::CameraPath(const std::vector<CameraKey>& keys, const glm::dvec3& middle, double fov)
    : begin_(keys.front().time),
      duration_(durationOf(keys)),
      eye_(wayOf(keys, [](const CameraKey& key) { return key.eye; })),
      look_at_(wayOf(keys, [&middle](const CameraKey& key) { return key.look_at.value_or(middle); })),
      up_(wayOf(keys, [](const CameraKey& key) { return key.up.value_or(glm::dvec3(0.0, 0.0, 1.0)); })),
      fov_(fovOf(keys, fov)) {}

void CameraPath::place(double share, shade::CameraOptions& options) const {
    const double time = begin_ + share * duration_;
    options.eye = at(eye_, time);
    options.look_at = at(look_at_, time);
    options.up = at(up_, time);
    options.fov = fov_(time);
}

}  // namespace stratum::animate
