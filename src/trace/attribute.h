// What is known of a grid of attributes without looking at its voxels again.
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace stratum::trace {

/// What gcode2vdb's colours are where the file states none. No sRGB of 8 bits is the same.
inline constexpr glm::vec3 kNoColor{0.8f, 0.8f, 0.8f};

/// What one attribute says of an object: whole numbers (tool, layer, feature), numbers (width, speed, time) or colours.
struct AttributeSummary {
    enum class Kind { integer, number, color };
    Kind kind = Kind::number;
    double least = 0.0, most = 0.0;   ///< of integers and numbers
    std::vector<glm::vec3> colors;    ///< the different ones, linear RGB, sorted by component; at most kMostColors
    std::vector<std::string> labels;  ///< names of the integers from 0, as far as the file has them
    std::vector<int> values;          ///< the different integers, ascending, if there are at most kMostValues
    std::uint64_t not_finite = 0;     ///< voxels or beads whose value is no finite number; they count for nothing above

    static constexpr std::size_t kMostColors = 4096;
    static constexpr std::size_t kMostValues = 64;
};

}  // namespace stratum::trace
