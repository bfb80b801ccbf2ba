// The mixes of a mixing hot end: which tool feeds how much of each filament.
//
// Sources: marlinfw.org/docs/gcode/M163.html, M164.html, M165.html; docs.duet3d.com (M567). Repetier-Firmware has the
// same M163 and M164.
#pragma once

#include "gcode/text/lexer.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace stratum::gcode {

/// From a bead on a tool lays a mix.
struct MixChange {
    std::uint32_t first_bead = 0;  ///< index into Toolpath::beads; may be one past the last
    std::uint8_t tool = 0;
    std::vector<double> shares;  ///< by filament; their sum is 1
    std::uint32_t line = 0;      ///< 1-based line in the source
};

/// A tool's new mix.
struct ToolMix {
    std::uint8_t tool = 0;
    std::vector<double> shares;
};

/// Collects factors, and tells the mix that a command gives a tool.
class Mixer {
public:
    static constexpr std::size_t kFilaments = 16;

    /// M163 S<filament> P<factor>: kept until a mix is made. Negative factors are 0; false for a filament that no
    /// machine has.
    bool setFactor(const Command& command);
    /// M164 [S<tool>]: the factors as the mix of that tool, or of the current one. Nothing if all are 0.
    std::optional<ToolMix> save(const Command& command, std::size_t current_tool) const;
    /// M165 A B C D H I: all factors at once, those left out are 0, as the mix of the current tool.
    std::optional<ToolMix> setAll(const Command& command, std::size_t current_tool);
    /// RepRapFirmware's M567 P<tool> E<factor>:<factor>...
    static std::optional<ToolMix> ofTool(const Command& command, std::size_t current_tool);

private:
    std::array<double, kFilaments> factors_{};
};

}  // namespace stratum::gcode
