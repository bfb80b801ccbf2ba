// Which parts of a bead's path in the plan are near another path.
#pragma once

#include "gcode/toolpath/plan_path.h"

#include <cstddef>
#include <vector>

namespace stratum::deposit {

/// A part of a path, mm from its start.
struct PathPart {
    double from = 0;
    double to = 0;
};

constexpr double kFineStep = 0.05;  ///< mm

/// Appends the parts of `path` that are within `reach` (mm) of `other`. Two segments: one part at most, in closed form.
/// With an arc: the ends are bisected to a micrometre, and parts shorter than kFineStep may be missed. Returns how many
/// distances that took; closed forms count as one.
std::size_t partsNear(const gcode::PlanPath& path, const gcode::PlanPath& other, double reach,
                      std::vector<PathPart>& parts);

/// The same for the places that are beside `other`: within `reach` of their nearest place on it, which is in its part
/// `held`, and seen from which they lie more across `path` than along it (so not ahead of an end, nor where the two
/// cross steeply). Parts may overlap. A path of no length has no direction: for it, reach and part decide.
std::size_t partsBeside(const gcode::PlanPath& path, const gcode::PlanPath& other, PathPart held, double reach,
                        std::vector<PathPart>& parts);

}  // namespace stratum::deposit
