// Axes besides X, Y, Z and E: W lowers the bed, others turn the part or the nozzle.
#include "gcode/machine/machine.h"
#include "gcode/text/limits.h"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace stratum::gcode {

void Machine::moveExtraAxes(const Command& command) {
    if (ExtraAxes::isMix(command)) {
        if (std::optional<ToolMix> mix = mixer_.setAll(command, tool_)) recorder_.changeMix(std::move(*mix), line_);
        return;
    }
    const double rise = extra_axes_.move(command, absolute_, unit_);
    if (rise == 0) return;
    Point target = frame_.position();
    target.z -= rise;
    if (rise > 0 || !(target.z <= kMaxCoordinate))
        return warn("W would move the bed into the nozzle, or further than any printer has room; it is not followed");
    warn("W lowers the bed, as on ORNL's machines: the print goes on above");
    if (moves_ != nullptr) recordPath(target, std::nullopt, 0, recorder_.toolpath().beads.size());
    frame_.lowerBed(-rise);
}

void Machine::checkExtraAxes() {
    extra_axes_.freeze();
    if (!extra_axes_.anyAway()) return;
    const std::string turned = extra_axes_.away("ABC");
    const std::string what = fmt::format("{} turn{} the part or the nozzle", turned, turned.size() == 1 ? "s" : "");
    if (!turned.empty() && !planar_)
        refuse(
            fmt::format("{}: what lies where X, Y and Z say is not the print (--planar reads it all the same)", what));
    if (!turned.empty()) warn(fmt::format("{}, which is not followed: what is read is not the print", what));
    if (const std::string beside = extra_axes_.away("UV"); !beside.empty())
        warn(fmt::format("{} not followed: beads lie where X, Y and Z say",
                         beside + (beside.size() == 1 ? " is" : " are")));
}

}  // namespace stratum::gcode
