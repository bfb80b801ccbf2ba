// Where what is made for a page goes.
#pragma once

#include <nlohmann/json.hpp>

#include <cstdint>
#include <functional>
#include <vector>

namespace stratum::view {

/// Called on the thread that makes pictures.
struct Output {
    std::function<void(const nlohmann::json& message)> text;
    /// A picture, or other bytes, with what is to be known of it.
    std::function<void(const nlohmann::json& head, const std::vector<std::uint8_t>& file)> picture;
};

}  // namespace stratum::view
