// One stiff or extreme case: what is measured, how large it may be, and why just so large.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace stratum::study {

struct StabilityCase {
    std::string family;    ///< field, rays or light
    std::string name;      ///< unique in its family
    std::string quantity;  ///< what is measured, with its unit
    double tolerance = 0;  ///< the largest value that passes
    std::string why;       ///< where the tolerance comes from, in a line
    /// Measures. 0 is perfect. A NaN, an exception, a crash or a hang fails the case.
    std::function<double()> measure;
};

std::vector<StabilityCase> fieldCases();
std::vector<StabilityCase> rayCases();
std::vector<StabilityCase> lightCases();

/// All of them, family by family.
std::vector<StabilityCase> stabilityCases();

/// "passed", or "failed"; a NaN has not passed.
std::string verdictOn(const StabilityCase& test, double measured);

}  // namespace stratum::study
