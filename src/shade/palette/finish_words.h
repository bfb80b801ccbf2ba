// How a filament's surface looks, by the words that it is sold with.
#pragma once

#include "shade/palette/filament_table.h"

#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// Of words as wordsOf() makes them. Flakes where they are sold as such (galaxy, glitter, sparkle, twinkling,
/// stardust); silk ("Silk+", "silky"); matte, also for fillers that take the gloss: wood, marble, carbon and glass
/// fibre ("PLA-CF"), pigment that glows; glossy. The first of these that a word names; else plain.
Finish finishOfWords(const std::vector<std::string>& words);

/// Of the name of a filament in a slicer's profile, whose part from "@" on is of the printer: "Generic PLA Silk @MK4".
Finish finishOfProfile(std::string_view name);

}  // namespace stratum::shade
