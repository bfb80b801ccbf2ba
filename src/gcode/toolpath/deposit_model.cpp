#include "gcode/toolpath/deposit_model.h"

#include <fmt/format.h>

namespace stratum::gcode {

std::string describe(const DepositModel& deposit) {
    std::string section = "stadium";
    if (deposit.corner_mm)
        section = fmt::format("corners of {:g} mm", *deposit.corner_mm);
    else if (!deposit.stadium())
        section = fmt::format("corners of {:g} % of half the height", 100 * deposit.corner_fraction);
    return fmt::format("{}, {}", deposit.settles() ? "settled" : "capsule", section);
}

}  // namespace stratum::gcode
