// The names of options of the reader and of the plastic, as command lines and other languages have them.
#pragma once

#include "gcode/machine/read_options.h"

#include <array>
#include <string_view>
#include <utility>

namespace stratum::gcode {

template <typename Value, std::size_t N>
using OptionNames = std::array<std::pair<std::string_view, Value>, N>;

inline constexpr OptionNames<ExtruderMode, 3> kExtruderModes = {
    {{"auto", ExtruderMode::automatic}, {"absolute", ExtruderMode::absolute}, {"relative", ExtruderMode::relative}}};

inline constexpr OptionNames<Firmware, 4> kFirmwares = {{{"auto", Firmware::automatic},
                                                         {"marlin", Firmware::marlin},
                                                         {"klipper", Firmware::klipper},
                                                         {"reprap", Firmware::reprap}}};

inline constexpr OptionNames<CornerRule, 8> kCornerRules = {{{"auto", CornerRule::automatic},
                                                             {"jerk", CornerRule::jerk},
                                                             {"slicer-jerk", CornerRule::slicer_jerk},
                                                             {"plan-jerk", CornerRule::plan_jerk},
                                                             {"junction-deviation", CornerRule::junction_deviation},
                                                             {"corner-velocity", CornerRule::corner_velocity},
                                                             {"marlin-jerk", CornerRule::marlin_jerk},
                                                             {"reprap-jerk", CornerRule::reprap_jerk}}};

inline constexpr OptionNames<DepositModel::Beads, 3> kBeadModels = {{{"capsule", DepositModel::Beads::capsule},
                                                                     {"grooves", DepositModel::Beads::grooves},
                                                                     {"settled", DepositModel::Beads::settled}}};

}  // namespace stratum::gcode
