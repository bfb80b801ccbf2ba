// A look ahead at how a program extrudes, for what it must know before its first bead and does not say.
//
// Four things differ: the word that drives the filament (E; A and B on MakerBot's machines; none where M101 and M103
// switch a motor on and off), whether E counts on or starts anew with each move, whether M82 or M83 says so, and
// whether a G90 that follows undoes M83 (in Marlin 2 it does, in Marlin 1 it did not, and slicers count on either).
// Sources: reprap.org/wiki/G-code (M101, M103, M108, BFB and MakerBot); Skeinforge's export; Kiri:Moto, whose relative
// E is set up by the printer's own start macro.
#pragma once

#include <cstddef>
#include <string_view>

namespace stratum::gcode {

struct ExtrusionScan {
    enum class Drive : unsigned char {
        e_word,    ///< the usual; also where there is nothing to go by
        axes_ab,   ///< A is the first extruder's filament, B the second's
        switched,  ///< on between M101 and M103
    };
    Drive drive = Drive::e_word;
    /// The numbers alone say that E is relative: no M82 or M83 comes before them, and E keeps falling back on moves,
    /// without G92.
    bool falls_back = false;
    /// The same of what follows a G90 that came after M83, which by Marlin's rules makes E absolute again.
    bool relative_after_g90 = false;
};

/// Reads from the start as far as it must: to the first E if M82 or M83 came before, else over a few hundred moves, or
/// to the end where there is no E.
ExtrusionScan scanExtrusion(std::string_view bytes);

/// ExtrusionScan::relative_after_g90, from a few hundred moves behind such G90. A byte search where there are none.
bool fallsBackAfterG90(std::string_view bytes);

}  // namespace stratum::gcode
