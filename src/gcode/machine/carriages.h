// Two carriages on one x axis that print the same: a copy beside the print, or its mirror image.
//
// Sources: marlinfw.org/docs/gcode/M605.html and Marlin's M605.cpp (S2 X<mm>: the second nozzle is that far to the
// right; S3: from there on it goes the other way); klipper3d.org/G-Codes.html, SET_DUAL_CARRIAGE MODE=COPY and MIRROR,
// and BCN3D's M605 S5 and S6, whose distance is the machine's own.
#pragma once

#include "gcode/text/lexer.h"
#include "gcode/toolpath/toolpath.h"
#include "gcode/toolpath/warning_log.h"

#include <cstdint>
#include <string_view>

namespace stratum::gcode {

/// What the second carriage prints.
class Carriages {
public:
    explicit Carriages(WarningLog& warnings) : warnings_(warnings) {}

    /// M605. `x` is the first nozzle's, mm; `unit` is mm in a unit of the program.
    void setMode(const Command& command, double x, double unit, std::uint32_t line);
    /// Klipper's MODE=.
    void setMode(std::string_view mode, std::uint32_t line);

    bool copies() const { return mode_ != Mode::alone; }
    /// The x of the second nozzle where the first is at `x`, mm.
    double copyOf(double x) const { return mode_ == Mode::mirror ? distance_ - x : distance_ + x; }
    Arc copyOf(const Arc& arc) const;

private:
    enum class Mode : std::uint8_t { alone, copy, mirror };

    void warnOfDistance(std::string_view command, std::uint32_t line);

    Mode mode_ = Mode::alone;
    double distance_ = 0;  // mm; of a mirror: the sum of both x
    WarningLog& warnings_;
};

}  // namespace stratum::gcode
