// M220 and M221: factors of all speeds and of the flow.
#include "gcode/machine/machine.h"
#include "gcode/text/limits.h"

#include <fmt/format.h>

namespace stratum::gcode {

void Machine::setSpeedFactor(const Command& command) {
    if (command.has('B')) speed_backup_ = speed_factor_;
    if (command.has('R')) speed_factor_ = speed_backup_;
    if (command.hasValue('S')) {
        const double percent = command.value('S');
        if (!(percent > 0 && percent <= kMaxFactor)) return warn("M220 with a speed that no printer has; ignored");
        speed_factor_ = percent / 100;
    }
    recorder_.setSpeed(feed_ * speed_factor_);
}

void Machine::setFlow(const Command& command) {
    if (!command.hasValue('S')) return;
    const double percent = command.value('S');
    if (!(percent >= 0 && percent <= kMaxFactor)) refuse(fmt::format("M221 S{} is no flow in per cent", percent));
    if (firmware_ == Firmware::klipper) return flow_.fill(percent / 100 * all_flow_);  // one factor for all tools
    std::size_t tool = tool_;
    for (const char letter : {'T', 'D'})  // Marlin, RepRapFirmware
        if (command.hasValue(letter) && command.value(letter) >= 0 && command.value(letter) < 255)
            tool = static_cast<std::size_t>(command.value(letter));
    flow_[tool] = percent / 100 * all_flow_;
}

}  // namespace stratum::gcode
