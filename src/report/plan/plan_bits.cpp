#include "report/plan/plan_bits.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace stratum::report {

std::uint64_t PlanBits::bitsOf(std::size_t i, std::size_t j, std::span<const std::uint32_t> layers) const {
    const std::vector<Entry>& entries = entries_[j * columns_i_ + i];
    std::uint64_t bits = 0;
    for (const std::uint32_t layer : layers) {
        const auto found = std::lower_bound(entries.begin(), entries.end(), layer,
                                            [](const Entry& entry, std::uint32_t l) { return entry.layer < l; });
        if (found != entries.end() && found->layer == layer) bits |= found->bits;
    }
    return bits;
}

PlanBits::Window::Window(const PlanBits& bits, std::size_t i, std::size_t j, std::span<const std::uint32_t> below,
                         int most)
    : most_(std::min(most, kMost)) {
    const int columns = (most_ + 7) / 8;
    for (int di = -columns; di <= columns; ++di)
        for (int dj = -columns; dj <= columns; ++dj) {
            const auto ci = static_cast<std::ptrdiff_t>(i) + di;
            const auto cj = static_cast<std::ptrdiff_t>(j) + dj;
            if (ci < 0 || cj < 0 || ci >= static_cast<std::ptrdiff_t>(bits.columns_i_) ||
                cj >= static_cast<std::ptrdiff_t>(bits.columns_j_))
                continue;
            const std::uint64_t word = bits.bitsOf(static_cast<std::size_t>(ci), static_cast<std::size_t>(cj), below);
            for (int x = 0; x < 8; ++x) at(8 * di + x) |= (word >> (8 * x) & 0xffU) << (8 * dj + kMost);
        }
}

double PlanBits::Window::distance2(int x, int y) const {
    double least = std::numeric_limits<double>::infinity();
    for (int dx = -most_; dx <= most_; ++dx) {
        const std::uint64_t row = at(x + dx);
        if (row == 0) continue;
        const std::uint64_t up = row >> (y + kMost);
        const std::uint64_t down = row << (63 - y - kMost);
        const int dy = std::min(up != 0 ? std::countr_zero(up) : 64, down != 0 ? std::countl_zero(down) : 64);
        if (dy <= most_) least = std::min(least, static_cast<double>(dx * dx + dy * dy));
    }
    return least;
}

}  // namespace stratum::report
