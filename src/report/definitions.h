// What each number of a report means: the one place of its title, unit and definition.
#pragma once

#include <span>
#include <string_view>

namespace stratum::report {

struct Definition {
    std::string_view key;      ///< in the JSON
    std::string_view section;  ///< heading
    std::string_view title;
    std::string_view unit;  ///< "" for a pure number or a text
    std::string_view text;
};

/// Of the whole print, in the order in which they are shown.
std::span<const Definition> numberDefinitions();
/// By layer number; and by slabs between heights.
std::span<const Definition> layerDefinitions();
std::span<const Definition> slabDefinitions();

}  // namespace stratum::report
