#include "base/options/json_section.h"

#include "base/error.h"
#include "base/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace stratum {

JsonSection::JsonSection(const Json& json, std::string path, const std::string& file)
    : json_(&json), path_(std::move(path)), file_(&file) {
    if (!json.is_object()) fail("", "an object, { ... }");
}

const nlohmann::json* JsonSection::find(std::string_view key) {
    known_.emplace_back(key);
    const auto found = json_->find(key);
    return found == json_->end() ? nullptr : &*found;
}

bool JsonSection::given(std::string_view key) const { return json_->contains(key); }

std::optional<double> JsonSection::number(std::string_view key) {
    const Json* j = find(key);
    if (!j) return std::nullopt;
    if (!j->is_number()) fail(key, "a number");
    return j->get<double>();
}

std::optional<std::int64_t> JsonSection::integer(std::string_view key, std::int64_t least, std::int64_t most) {
    const Json* j = find(key);
    if (!j) return std::nullopt;
    if (!j->is_number_integer() ||
        (j->is_number_unsigned() && j->get<std::uint64_t>() > static_cast<std::uint64_t>(most)) ||
        j->get<std::int64_t>() < least || j->get<std::int64_t>() > most)
        fail(key, fmt::format("a whole number from {} to {}", least, most));
    return j->get<std::int64_t>();
}

std::optional<bool> JsonSection::flag(std::string_view key) {
    const Json* j = find(key);
    if (!j) return std::nullopt;
    if (!j->is_boolean()) fail(key, "true or false");
    return j->get<bool>();
}

std::optional<std::string> JsonSection::text(std::string_view key) {
    const Json* j = find(key);
    if (!j) return std::nullopt;
    if (!j->is_string()) fail(key, "a text");
    return j->get<std::string>();
}

std::vector<double> JsonSection::list(std::string_view key, char /*separator*/) {
    const Json* j = find(key);
    if (!j) return {};
    if (j->is_number()) return {j->get<double>()};
    if (!j->is_array() || j->empty() || !std::all_of(j->begin(), j->end(), [](const Json& v) { return v.is_number(); }))
        fail(key, "numbers, [ ... ]");
    return j->get<std::vector<double>>();
}

std::vector<std::string> JsonSection::texts(std::string_view key) {
    const Json* j = find(key);
    if (!j) return {};
    if (j->is_string()) return {j->get<std::string>()};
    if (!j->is_array() || !std::all_of(j->begin(), j->end(), [](const Json& v) { return v.is_string(); }))
        fail(key, "a text, or a list of them");
    return j->get<std::vector<std::string>>();
}

bool JsonSection::says(std::string_view key, std::string_view word) {
    const Json* j = find(key);
    return j != nullptr && j->is_string() && j->get_ref<const std::string&>() == word;
}

std::vector<double> JsonSection::numbers(std::string_view key, std::size_t count) {
    const Json* j = find(key);
    if (!j) return {};
    const std::string expected = fmt::format("{} numbers, [ ... ]", count);
    if (!j->is_array()) fail(key, expected);
    return numbersOf(key, {count}, expected);
}

std::optional<glm::dvec3> JsonSection::vector(std::string_view key) {
    const std::vector<double> v = numbers(key, 3);
    if (v.empty()) return std::nullopt;
    return glm::dvec3(v[0], v[1], v[2]);
}

std::optional<JsonSection> JsonSection::section(std::string_view key) {
    const Json* j = find(key);
    if (!j) return std::nullopt;
    return JsonSection(*j, place(key), *file_);
}

void JsonSection::finish() const {
    for (const auto& item : json_->items()) {
        if (std::find(known_.begin(), known_.end(), item.key()) != known_.end()) continue;
        // The beginning is enough to tell: a key may be as long as the file.
        const std::string key = item.key().substr(0, 64);
        const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
            return editDistance(a, key) < editDistance(b, key);
        });
        throw InputError(fmt::format("{}: {}: unknown key; did you mean '{}'?", *file_, place(key), *nearest));
    }
}

std::string JsonSection::place(std::string_view key) const {
    return path_.empty() ? std::string(key) : key.empty() ? path_ : fmt::format("{}.{}", path_, key);
}

std::string JsonSection::called(std::string_view key) const {
    const std::string where = place(key);
    return fmt::format("{}: {}", *file_, where.empty() ? "the file" : where);
}

void JsonSection::fail(std::string_view key, std::string_view expected) const {
    throw InputError(fmt::format("{}: expected {}", called(key), expected));
}

}  // namespace stratum
