// What is known of a grid of attributes without looking at its voxels again.
#pragma once

#include <glm/vec3.hpp>

#include <string>
#include <vector>

namespace stratum::march {

/// What one attribute says of an object: whole numbers (tool, layer, feature), numbers (width, speed, time) or colours.
struct AttributeSummary {
    enum class Kind { integer, number, color };
    Kind kind = Kind::number;
    double least = 0.0, most = 0.0;   ///< of integers and numbers
    std::vector<glm::vec3> colors;    ///< the different ones, linear RGB, sorted by component; at most kMostColors
    std::vector<std::string> labels;  ///< names of the integers from 0, as far as the file has them

    static constexpr std::size_t kMostColors = 4096;
};

}  // namespace stratum::march
