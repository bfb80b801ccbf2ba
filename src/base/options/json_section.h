// One object of a JSON file, read key by key with errors that say where.
#pragma once

#include "base/options/option_source.h"

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum {

/// Every key that is asked for is known; finish() refuses all others. Keeps references to the JSON and the file's name.
class JsonSection final : public OptionSource {
public:
    using Json = nlohmann::json;

    /// @param path  where the object is in the file, e.g. "objects[2].transform"; empty for the file itself
    /// Throws InputError if it is no object.
    JsonSection(const Json& json, std::string path, const std::string& file);

    const Json* find(std::string_view key);
    std::optional<double> number(std::string_view key) override;
    std::optional<std::int64_t> integer(std::string_view key, std::int64_t least, std::int64_t most) override;
    std::optional<bool> flag(std::string_view key) override;
    std::optional<std::string> text(std::string_view key) override;
    std::vector<double> list(std::string_view key, char separator = ',') override;
    std::vector<std::string> texts(std::string_view key) override;
    bool says(std::string_view key, std::string_view word) override;
    bool given(std::string_view key) const override;
    std::string called(std::string_view key) const override;
    [[noreturn]] void fail(std::string_view key, std::string_view expected) const override;
    [[noreturn]] void refuse(std::string_view key, std::string_view expected) const override { fail(key, expected); }

    void read(std::string_view key, std::string& value) { assign(value, text(key)); }
    void read(std::string_view key, bool& value) { assign(value, flag(key)); }
    void read(std::string_view key, double& value) { assign(value, number(key)); }
    void read(std::string_view key, glm::dvec3& value) { assign(value, vector(key)); }
    void read(std::string_view key, std::optional<glm::dvec3>& value) { assign(value, vector(key)); }
    template <typename Integer>
    void readInteger(std::string_view key, Integer& value) {
        constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<Integer>::max());
        constexpr auto kMostRead = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
        assign(value, integer(key, 0, static_cast<std::int64_t>(kMost < kMostRead ? kMost : kMostRead)));
    }
    /// Exactly `count` numbers; empty if the key is not there.
    std::vector<double> numbers(std::string_view key, std::size_t count);
    /// The object under a key, or nothing.
    std::optional<JsonSection> section(std::string_view key);
    /// Throws for keys that nobody asked for, with the known one that is most like it.
    void finish() const;
    std::string place(std::string_view key) const;
    const std::string& file() const { return *file_; }

private:
    std::optional<glm::dvec3> vector(std::string_view key);

    const Json* json_;
    std::string path_;
    const std::string* file_;
    std::vector<std::string> known_;
};

}  // namespace stratum
