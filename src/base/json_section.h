// One object of a JSON file, read key by key with errors that say where.
#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum {

/// Every key that is asked for is known; finish() refuses all others. Keeps references to the JSON and the file's name.
class JsonSection {
public:
    using Json = nlohmann::json;

    /// @param path  where the object is in the file, e.g. "objects[2].transform"; empty for the file itself
    /// Throws InputError if it is no object.
    JsonSection(const Json& json, std::string path, const std::string& file);

    const Json* find(const char* key);
    void read(const char* key, std::string& value);
    void read(const char* key, bool& value);
    void read(const char* key, double& value);
    void read(const char* key, std::optional<glm::dvec3>& value);
    void read(const char* key, glm::dvec3& value);
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
    std::vector<double> numbers(const char* key, std::size_t count);
    /// The object under a key, or nothing.
    std::optional<JsonSection> section(const char* key);
    /// Throws for keys that nobody asked for, with the known one that is most like it.
    void finish() const;
    std::string place(std::string_view key) const;
    const std::string& file() const { return file_; }
    [[noreturn]] void fail(std::string_view key, std::string_view expected) const;

private:
    const Json& json_;
    std::string path_;
    const std::string& file_;
    std::vector<std::string> known_;
};

}  // namespace stratum
