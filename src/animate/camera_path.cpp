#include "animate/camera_path.h"

#include "base/error.h"
#include "base/input_file.h"
#include "base/options/json_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>

namespace stratum::animate {
namespace {

// At the end of a curve: that of a parabola through three values, as far as it stays monotone.
double endSlope(double h0, double h1, double d0, double d1) {
    const double slope = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
    if (!(slope * d0 > 0)) return 0;
    if (!(d0 * d1 > 0) && std::abs(slope) > 3 * std::abs(d0)) return 3 * d0;
    return slope;
}

}  // namespace

MonotoneCubic::MonotoneCubic(std::vector<double> places, std::vector<double> values)
    : places_(std::move(places)), values_(std::move(values)), slopes_(values_.size(), 0.0) {
    const std::size_t count = values_.size();
    if (count < 2) return;
    std::vector<double> lengths;
    std::vector<double> rises;
    lengths.reserve(count - 1);
    rises.reserve(count - 1);
    for (std::size_t n = 0; n + 1 < count; ++n) {
        lengths.push_back(places_[n + 1] - places_[n]);
        rises.push_back((values_[n + 1] - values_[n]) / lengths[n]);
    }
    if (count == 2) {
        slopes_ = {rises[0], rises[0]};
        return;
    }
    for (std::size_t n = 1; n + 1 < count; ++n) {
        const double before = rises[n - 1];
        const double after = rises[n];
        if (!(before * after > 0)) continue;  // it turns here
        const double share = (lengths[n - 1] + 2 * lengths[n]) / (3 * (lengths[n - 1] + lengths[n]));
        slopes_[n] = 1 / (share / before + (1 - share) / after);
    }
    slopes_.front() = endSlope(lengths[0], lengths[1], rises[0], rises[1]);
    slopes_.back() = endSlope(lengths[count - 2], lengths[count - 3], rises[count - 2], rises[count - 3]);
}

double MonotoneCubic::operator()(double place) const {
    if (!(place > places_.front())) return values_.front();
    if (!(place < places_.back())) return values_.back();
    const auto next =
        static_cast<std::size_t>(std::upper_bound(places_.begin(), places_.end(), place) - places_.begin());
    const std::size_t n = next - 1;
    const double length = places_[next] - places_[n];
    const double t = (place - places_[n]) / length;
    const double rest = 1 - t;
    // Hermite's form, with the value at a place itself exact.
    return values_[n] + t * t * (3 - 2 * t) * (values_[next] - values_[n]) +
           length * t * rest * (rest * slopes_[n] - t * slopes_[next]);
}

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
