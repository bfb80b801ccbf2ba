#include "base/json_section.h"

#include "base/error.h"
#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace stratum {

JsonSection::JsonSection(const Json& json, std::string path, const std::string& file)
    : json_(json), path_(std::move(path)), file_(file) {
    if (!json.is_object()) fail("", "an object, { ... }");
}

const nlohmann::json* JsonSection::find(const char* key) {
    known_.emplace_back(key);
    const auto found = json_.find(key);
    return found == json_.end() ? nullptr : &*found;
}

void JsonSection::read(const char* key, std::string& value) {
    if (const Json* j = find(key)) {
        if (!j->is_string()) fail(key, "a text");
        value = j->get<std::string>();
    }
}

void JsonSection::read(const char* key, bool& value) {
    if (const Json* j = find(key)) {
        if (!j->is_boolean()) fail(key, "true or false");
        value = j->get<bool>();
    }
}

void JsonSection::read(const char* key, double& value) {
    if (const Json* j = find(key)) {
        if (!j->is_number()) fail(key, "a number");
        value = j->get<double>();
    }
}

void JsonSection::read(const char* key, std::optional<glm::dvec3>& value) {
    if (const auto v = numbers(key, 3); !v.empty()) value = glm::dvec3(v[0], v[1], v[2]);
}

void JsonSection::read(const char* key, glm::dvec3& value) {
    if (const auto v = numbers(key, 3); !v.empty()) value = glm::dvec3(v[0], v[1], v[2]);
}

std::vector<double> JsonSection::numbers(const char* key, std::size_t count) {
    const Json* j = find(key);
    if (!j) return {};
    const bool good = j->is_array() && j->size() == count &&
                      std::all_of(j->begin(), j->end(), [](const Json& v) { return v.is_number(); });
    if (!good) fail(key, fmt::format("{} numbers, [ ... ]", count));
    return j->get<std::vector<double>>();
}

std::optional<JsonSection> JsonSection::section(const char* key) {
    const Json* j = find(key);
    if (!j) return std::nullopt;
    return JsonSection(*j, place(key), file_);
}

void JsonSection::finish() const {
    for (const auto& item : json_.items()) {
        if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
        // The beginning is enough to tell: a key may be as long as the file.
        const std::string key = item.key().substr(0, 64);
        const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
            return editDistance(a, key) < editDistance(b, key);
        });
        throw InputError(fmt::format("{}: {}: unknown key; did you mean '{}'?", file_, place(key), *nearest));
    }
}

std::string JsonSection::place(std::string_view key) const {
    return path_.empty() ? std::string(key) : key.empty() ? path_ : fmt::format("{}.{}", path_, key);
}

void JsonSection::fail(std::string_view key, std::string_view expected) const {
    const std::string where = place(key);
    throw InputError(fmt::format("{}: {}: expected {}", file_, where.empty() ? "the file" : where, expected));
}

}  // namespace stratum
