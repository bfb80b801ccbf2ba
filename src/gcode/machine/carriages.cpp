#include "gcode/machine/carriages.h"

#include "base/text.h"
#include "gcode/text/limits.h"

#include <fmt/format.h>

#include <string>

namespace stratum::gcode {

void Carriages::warnOfDistance(std::string_view command, std::uint32_t line) {
    mode_ = Mode::alone;
    warnings_.add(fmt::format("{} prints a second part, but how far from the first is not in the file; it is left out "
                              "(M605 S2 X150 would say it)",
                              command),
                  line);
}

void Carriages::setMode(const Command& command, double x, double unit, std::uint32_t line) {
    const double mode = command.hasValue('S') ? command.value('S') : 0;
    if (mode == 2) {
        const double distance = command.hasValue('X') ? command.value('X') * unit : 0;
        if (!(distance > 0 && distance <= kMaxCoordinate)) return warnOfDistance("M605 S2", line);
        mode_ = Mode::copy;
        distance_ = distance;
    } else if (mode == 3) {
        if (mode_ != Mode::copy) return warnOfDistance("M605 S3", line);
        mode_ = Mode::mirror;
        distance_ += 2 * x;
    } else if (mode == 5 || mode == 6) {
        warnOfDistance(mode == 5 ? "M605 S5" : "M605 S6", line);
    } else {
        mode_ = Mode::alone;
    }
}

void Carriages::setMode(std::string_view mode, std::uint32_t line) {
    mode_ = Mode::alone;
    const std::string name = upperCase(std::string(mode));
    if (name == "COPY" || name == "MIRROR") warnOfDistance("SET_DUAL_CARRIAGE", line);
}

Arc Carriages::copyOf(const Arc& arc) const {
    Arc copy = arc;
    copy.center_x = copyOf(arc.center_x);
    if (mode_ == Mode::mirror) copy.sweep = -arc.sweep;
    return copy;
}

}  // namespace stratum::gcode
