// Warnings about the input, each text once, with its first line and its count.
#pragma once

#include "gcode/toolpath/toolpath.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace stratum::gcode {

/// A warning in one line for people: "NAME:LINE: TEXT (3 times)".
/// @param name  of the file
std::string describe(const Warning& warning, std::string_view name);

/// Collects warnings. Not thread-safe. The number of distinct texts is bounded, so that a damaged file can't fill
/// memory.
class WarningLog {
public:
    void add(std::string_view text, std::uint32_t line);
    /// The warnings in order of first appearance; the log is empty afterwards.
    std::vector<Warning> take();

private:
    struct Hash {
        using is_transparent = void;
        std::size_t operator()(std::string_view text) const { return std::hash<std::string_view>{}(text); }
    };
    std::vector<Warning> warnings_;
    std::unordered_map<std::string, std::size_t, Hash, std::equal_to<>> index_;
};

}  // namespace stratum::gcode
