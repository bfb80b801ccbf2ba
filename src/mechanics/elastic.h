// Elastic constants of the plastic, as a user gives them.
#pragma once

#include <array>
#include <string_view>

namespace stratum::mechanics {

/// Orthotropic: axis 1 along the bead, 2 across it in the plan, 3 up (for level beads). Moduli in MPa.
struct Elastic {
    bool isotropic = true;
    std::array<double, 3> young{};    ///< E1, E2, E3
    std::array<double, 3> poisson{};  ///< nu12, nu13, nu23: strain along the second by a stress along the first
    std::array<double, 3> shear{};    ///< G12, G13, G23
};

constexpr double kDefaultPoisson = 0.35;  ///< of PLA, ABS and PETG to a few hundredths

/// "E", "E,NU", or "E1,E2,E3,NU12,NU13,NU23,G12,G13,G23" as in Abaqus and CalculiX. Throws UsageError for other counts
/// and for constants of which no material can be made: the stored energy must be positive for every strain (Lempriere,
/// AIAA Journal 6, 1968).
Elastic parseElastic(std::string_view text);

}  // namespace stratum::mechanics
