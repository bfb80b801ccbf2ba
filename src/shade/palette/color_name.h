// A color by its name: of CSS, by its numbers, or of a real filament.
#pragma once

#include "shade/palette/filament_table.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

struct ColorName {
    std::uint32_t color = 0;  ///< sRGB, 0xRRGGBB
    std::string name;         ///< as given, or the full name of the filament
    std::string brdf;         ///< the material that looks so, see makeBrdf(); for plain filament the color itself
};

/// "#rrggbb", "#rgb", a name in CSS Color 4, or words of a filament's maker, material and name, in any case and order:
/// "Prusament Galaxy Black". Of the filaments that have all of the words, those with the fewest other words in their
/// names are meant; they must be of one color and finish. The table is read only for such words. Throws UsageError that
/// begins with `option` and names the three nearest, InputError if the table can't be read.
ColorName colorNamed(std::string_view text, std::string_view option);

/// The filaments that have all of the words, in the order of the table; all of them for no words.
std::vector<const Filament*> filamentsWith(std::string_view words);

/// One line each: full name, color, finish.
std::string listFilaments(std::string_view words);

/// The material of such a filament: plain: "#rrggbb"; matte:, silk:, glitter: or plastic: with its reflectance.
std::string brdfOf(std::uint32_t color, Finish finish);

}  // namespace stratum::shade
