// Steps of reading, as messages for pages.
#pragma once

#include "assemble/file/read_events.h"

#include <nlohmann/json.hpp>

#include <functional>

namespace stratum::view {

/// Tells the beginning of each step, and how much of it is done ten times a second at most.
assemble::ReadEvents loadingEvents(std::function<void(const nlohmann::json& message)> tell);

}  // namespace stratum::view
