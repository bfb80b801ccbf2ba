#include "gcode/toolpath/deposit_model.h"

#include <fmt/format.h>

namespace stratum::gcode {

std::string describe(const DepositModel& deposit) {
    std::string section = "stadium";
    if (deposit.corner_mm)
        section = fmt::format("corners of {:g} mm", *deposit.corner_mm);
    else if (!deposit.stadium())
        section = fmt::format("corners of {:g} % of half the height", 100 * deposit.corner_fraction);
    std::string text = fmt::format("{}, {}",
                                   deposit.swells()    ? "settled"
                                   : deposit.settles() ? "grooves"
                                                       : "capsule",
                                   section);
    if (deposit.flow_lag) text += fmt::format(", flow lag {:g} s", *deposit.flow_lag);
    if (deposit.flow_lag && deposit.pressure_advance)
        text += fmt::format(", pressure advance {:g} s", *deposit.pressure_advance);
    if (deposit.strings) text += ", strings";
    if (deposit.sag > 0) text += fmt::format(", sag {:g} % of the span", 100 * deposit.sag);
    if (deposit.swells() && deposit.crown > 0)
        text += fmt::format(", crowns of {:g} % of the height", 100 * deposit.crown);
    return text;
}

}  // namespace stratum::gcode
