#include "mechanics/elastic.h"

#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace stratum::mechanics {
namespace {

[[noreturn]] void refuse(std::string_view text, const char* why) {
    throw UsageError(
        fmt::format("--elastic {}: {}; expected E or E,NU, or E1,E2,E3,NU12,NU13,NU23,G12,G13,G23 with moduli in "
                    "MPa, e.g. 3500,0.35",
                    text, why));
}

std::vector<double> numbersOf(std::string_view text) {
    std::vector<double> numbers;
    for (const std::string_view word : split(text)) {
        const auto value = parsed<double>(word);
        if (!value || !std::isfinite(*value)) refuse(text, "is not a list of numbers");
        numbers.push_back(*value);
    }
    return numbers;
}

bool storesEnergy(const Elastic& e) {
    const auto& [e1, e2, e3] = e.young;
    const auto& [nu12, nu13, nu23] = e.poisson;
    const double nu21 = nu12 * e2 / e1;
    const double nu31 = nu13 * e3 / e1;
    const double nu32 = nu23 * e3 / e2;
    return nu12 * nu21 < 1 && nu13 * nu31 < 1 && nu23 * nu32 < 1 &&
           1 - nu12 * nu21 - nu23 * nu32 - nu31 * nu13 - 2 * nu21 * nu32 * nu13 > 0;
}

}  // namespace

Elastic parseElastic(std::string_view text) {
    const std::vector<double> n = numbersOf(text);
    Elastic elastic;
    if (n.size() <= 2) {
        const double nu = n.size() == 2 ? n[1] : kDefaultPoisson;
        elastic.young.fill(n[0]);
        elastic.poisson.fill(nu);
        elastic.shear.fill(n[0] / (2 * (1 + nu)));
    } else if (n.size() == 9) {
        elastic.isotropic = false;
        std::copy_n(n.begin(), 3, elastic.young.begin());
        std::copy_n(n.begin() + 3, 3, elastic.poisson.begin());
        std::copy_n(n.begin() + 6, 3, elastic.shear.begin());
    } else {
        refuse(text, "has neither one, two nor nine numbers");
    }
    const auto positive = [](double modulus) { return modulus > 0; };
    if (!std::all_of(elastic.young.begin(), elastic.young.end(), positive) ||
        !std::all_of(elastic.shear.begin(), elastic.shear.end(), positive))
        refuse(text, "moduli must be positive, and Poisson's ratio more than -1");
    if (!storesEnergy(elastic)) refuse(text, "Poisson's ratios are too large for a material that is stable");
    return elastic;
}

}  // namespace stratum::mechanics
