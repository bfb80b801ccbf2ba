// The names of options of the reader and of the plastic, as command lines and other languages have them.
#pragma once

#include "base/names.h"
#include "gcode/printer/read_options.h"

namespace stratum::gcode {

inline constexpr Names<ExtruderMode, 3> kExtruderModes = {
    {{"auto", ExtruderMode::automatic}, {"absolute", ExtruderMode::absolute}, {"relative", ExtruderMode::relative}}};

inline constexpr Names<Firmware, 4> kFirmwares = {{{"auto", Firmware::automatic},
                                                   {"marlin", Firmware::marlin},
                                                   {"klipper", Firmware::klipper},
                                                   {"reprap", Firmware::reprap}}};

inline constexpr Names<CornerRule, 10> kCornerRules = {{{"auto", CornerRule::automatic},
                                                        {"jerk", CornerRule::jerk},
                                                        {"slicer-jerk", CornerRule::slicer_jerk},
                                                        {"plan-jerk", CornerRule::plan_jerk},
                                                        {"junction-deviation", CornerRule::junction_deviation},
                                                        {"corner-velocity", CornerRule::corner_velocity},
                                                        {"marlin-jerk", CornerRule::marlin_jerk},
                                                        {"reprap-jerk", CornerRule::reprap_jerk},
                                                        {"programmed", CornerRule::programmed},
                                                        {"bambu-jerk", CornerRule::bambu_jerk}}};

inline constexpr Names<DepositModel::Beads, 3> kBeadModels = {{{"capsule", DepositModel::Beads::capsule},
                                                               {"grooves", DepositModel::Beads::grooves},
                                                               {"settled", DepositModel::Beads::settled}}};

}  // namespace stratum::gcode
