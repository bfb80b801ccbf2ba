// Scans ahead for a program's way of extruding, which the simulator must know before the first bead.
//
// Four things differ: the parameter that drives the filament (E; A and B on MakerBot's machines; none where M101 and
// M103 switch a motor on and off), whether E is absolute or relative, whether M82 or M83 states that, and whether a G90
// that follows undoes M83 (in Marlin 2 it does, in Marlin 1 it did not, and slicers rely on either).
// Sources: reprap.org/wiki/G-code (M101, M103, M108, BFB and MakerBot); Skeinforge's export; Kiri:Moto, whose relative
// E is set up by the printer's own start macro.
#pragma once

#include <cstddef>
#include <string_view>

namespace stratum::gcode {

struct ExtrusionScan {
    enum class Drive : unsigned char {
        e_word,    ///< the usual; also if nothing is known
        axes_ab,   ///< A is the first extruder's filament, B the second's
        switched,  ///< on between M101 and M103
    };
    Drive drive = Drive::e_word;
    /// The numbers show that E is relative: without M82, M83 or G92, E repeatedly decreases, or stays, between moves.
    bool falls_back = false;
    /// M82 or M83 comes, but E moves before it: until then the machine is as it was switched on.
    bool mode_follows = false;
    /// Some E of the moves that were read is not above the one before, and none is of a retraction in absolute E.
    bool repeats = false;
    /// The same after a G90 that follows M83, which by Marlin's rules makes E absolute again.
    bool relative_after_g90 = false;
    /// The first E, if it is absolute, is where a part of a longer program begins, and pushes nothing out.
    bool cut = false;
};

/// Reads from the start as far as needed: to the first E if M82 or M83 came before (a few moves farther if that is
/// large), else over a few hundred moves, or to the end if there is no E.
ExtrusionScan scanExtrusion(std::string_view bytes);

/// ExtrusionScan::relative_after_g90, from a few hundred moves behind such G90. A byte search where there are none.
bool fallsBackAfterG90(std::string_view bytes);

}  // namespace stratum::gcode
