// What a page may say.
#pragma once

#include "view/asked/view_state.h"

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

namespace stratum::view {

/// Show this.
struct ShowMessage {
    std::uint64_t number = 0;  ///< of the page's; pictures say which one they answer
    bool moving = false;       ///< more will follow at once: a quick picture is enough
    ViewState state;
};
/// What is at this place of the picture?
struct InspectMessage {
    std::uint64_t number = 0;
    double x = 0.0, y = 0.0;  ///< from the upper left corner, of width and height
};
/// Make a finished picture of this, as a file.
struct SaveMessage {
    std::uint64_t number = 0;
    ViewState state;
};
/// A picture has arrived and is shown.
struct ShownMessage {};
/// Look at another of the inputs.
struct OpenMessage {
    std::size_t file = 0;
};

using Message = std::variant<ShowMessage, InspectMessage, SaveMessage, ShownMessage, OpenMessage>;

/// Throws InputError for anything else.
Message parseMessage(std::string_view text);

}  // namespace stratum::view
