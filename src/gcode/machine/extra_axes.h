// Axes beyond x, y, z and the extruder: A, B, C, U, V, W.
//
// Sources: NIST RS274/NGC 2.1.2.1 and table 2 (A, B and C turn about x, y and z; U, V and W are parallel to them);
// ORNL Slicer, which lowers the table of large machines by W instead of raising the nozzle.
#pragma once

#include "gcode/text/lexer.h"

#include <array>
#include <cstdint>
#include <string>

namespace stratum::gcode {

/// The program's coordinates of these axes.
class ExtraAxes {
public:
    /// Without `all`, A and B are extruders.
    explicit ExtraAxes(bool all) : letters_(Command::maskOf(all ? "ABCUVW" : "CUVW")) {}

    bool has(const Command& command) const { return command.hasAny(letters_); }
    /// Whether the words are shares of filaments (Marlin's DIRECT_MIXING_IN_G1: A, B, C, D, H), not places of axes.
    static bool isMix(const Command& command);
    /// The words of a move. Returns how far the bed moves towards the nozzle, mm; negative: away from it.
    double move(const Command& command, bool absolute, double unit);
    /// G92: the axes are there.
    void setPosition(const Command& command, double unit);
    /// A bead is laid: what A, B, C, U and V are at is where the print belongs.
    void freeze() { frozen_ = true; }

    /// Those among `letters` that are elsewhere than where the first bead was laid: "A and C"; empty if there are none.
    std::string away(std::string_view letters) const;
    bool anyAway() const { return away_; }

private:
    std::uint32_t letters_;
    std::array<double, 32> at_{};         // by letter
    std::array<double, 32> reference_{};  // where the print belongs
    bool frozen_ = false;
    bool away_ = false;
};

}  // namespace stratum::gcode
