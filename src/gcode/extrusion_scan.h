// A look ahead at how a program extrudes, for what it must know before its first bead and does not say.
//
// Three things differ: the word that drives the filament (E; A and B on MakerBot's machines; none where M101 and M103
// switch a motor on and off), whether E counts on or starts anew with each move, and whether M82 or M83 says so.
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
};

/// Reads from the start as far as it must: to the first E if M82 or M83 came before, else over a few hundred moves, or
/// to the end where there is no E.
ExtrusionScan scanExtrusion(std::string_view bytes);

}  // namespace stratum::gcode
