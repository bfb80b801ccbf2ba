#include "animate/pace.h"

namespace stratum::animate {

double paced(double share, double ease) {
    if (ease <= 0.0) return share;
    const double speed = 1.0 / (1.0 - ease);
    if (share < ease) return 0.5 * speed * share * share / ease;
    if (share > 1.0 - ease) return 1.0 - 0.5 * speed * (1.0 - share) * (1.0 - share) / ease;
    return speed * (share - 0.5 * ease);
}

std::vector<double> growthShares(std::size_t frames, std::size_t held, double ease) {
    std::vector<double> shares(frames, 1.0);
    const std::size_t growing = frames - held;
    for (std::size_t n = 1; n < growing; ++n)
        shares[n - 1] = paced(static_cast<double>(n) / static_cast<double>(growing), ease);
    return shares;
}

}  // namespace stratum::animate
