// Summary of an attribute's values: range, labels, colors.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

namespace stratum::trace {

/// gcode2vdb's color for beads whose file states none. Different from every 8-bit sRGB color.
inline constexpr glm::vec3 kNoColor{0.8f, 0.8f, 0.8f};

/// Orders values by component.
struct Before {
    bool operator()(const glm::vec3& a, const glm::vec3& b) const {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    }
};

/// The values of one attribute of an object: integers (tool, layer, feature), numbers (width, speed, time) or colors.
struct AttributeSummary {
    enum class Kind { integer, number, color };
    Kind kind = Kind::number;
    double least = 0.0, most = 0.0;   ///< of integers and numbers
    std::vector<glm::vec3> colors;    ///< distinct, linear RGB, sorted by component; at most kMostColors
    std::vector<std::string> labels;  ///< names of the integers from 0, as far as the file has them
    std::vector<int> values;          ///< the distinct integers, ascending, if there are at most kMostValues
    std::uint64_t not_finite = 0;     ///< voxels or beads whose value is not finite; the fields above ignore them

    static constexpr std::size_t kMostColors = 4096;
    static constexpr std::size_t kMostValues = 64;
};

}  // namespace stratum::trace
