// What a page may say.
#pragma once

#include "view/asked/view_state.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace stratum::view {

/// Show this.
struct ShowMessage {
    std::uint64_t number = 0;  ///< of the page's; pictures say which one they answer
    bool moving = false;       ///< more will follow at once: a quick picture is enough
    /// The page draws moving pictures itself: while it moves, none is wanted; at rest what it needs for them, then the
    /// finished one.
    bool own = false;
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
/// Don't make the pictures that are to be saved.
struct CancelMessage {};
/// A picture has arrived and is shown.
struct ShownMessage {};
/// Send the beads of the print, for pages that draw them.
struct BeadsMessage {};
/// Send its travels, retractions, seams and stops, for pages that draw them.
struct MovesMessage {};
/// Send heights and times of its layers.
struct LayersMessage {};
/// Send the lines of the program around that of a bead.
struct ProgramMessage {
    std::uint32_t bead = 0;
};
/// Search the program: for the next line with a text behind `line`, for `line` itself, or for what is printed at a
/// time.
struct FindMessage {
    std::string text;               ///< with small and large letters alike; empty: none
    std::uint32_t line = 0;         ///< from 1; with a text, 0 is before the first
    bool back = false;              ///< the text before `line` instead of behind it
    std::optional<double> seconds;  ///< since the start
};
/// Look at another of the inputs.
struct OpenMessage {
    std::size_t file = 0;
};

using Message = std::variant<ShowMessage, InspectMessage, SaveMessage, CancelMessage, ShownMessage, BeadsMessage,
                             MovesMessage, LayersMessage, ProgramMessage, FindMessage, OpenMessage>;

/// Throws InputError for anything else.
Message parseMessage(std::string_view text);

}  // namespace stratum::view
