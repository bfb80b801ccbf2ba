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

void Machine::setHeatOrFan(const Command& command) {
    if (command.code == 104 || command.code == 109) {
        if (!command.hasValue('S') && !command.hasValue('R')) return;
        return recorder_.heat(command.hasValue('T') ? command.value('T') : static_cast<double>(tool_),
                              command.value(command.hasValue('S') ? 'S' : 'R'), line_);
    }
    // Fan 1 is that of the part on Bambu's machines; those behind it cool other things.
    if (command.hasValue('P') && command.value('P') >= 2) return;
    const double speed = command.code == 107 ? 0 : command.hasValue('S') ? command.value('S') : 255;
    // RepRapFirmware takes shares, too.
    recorder_.blow(firmware_ == Firmware::reprap && speed <= 1 ? 100 * speed : speed / 2.55, line_);
}

}  // namespace stratum::gcode
