#include "report/plan/plan_bits.h"

#include <algorithm>
#include <bit>
#include <limits>

namespace stratum::report {

std::uint64_t PlanBits::bitsOf(std::size_t column, std::span<const std::uint32_t> layers) const {
    const std::vector<Entry>& entries = entries_[column];
    std::uint64_t bits = 0;
    for (const std::uint32_t layer : layers) {
        const auto found = std::lower_bound(entries.begin(), entries.end(), layer,
                                            [](const Entry& entry, std::uint32_t l) { return entry.layer < l; });
        if (found != entries.end() && found->layer == layer) bits |= found->bits;
    }
    return bits;
}

PlanBits::Window::Window(const PlanBits& bits, std::size_t column, std::span<const std::uint32_t> below, int most)
    : most_(std::min(most, kMost)),
      margin_((most_ + 7) / 8 * 8),
      words_(static_cast<std::size_t>(2 * margin_ + 8 + 63) / 64),
      rows_(static_cast<std::size_t>(2 * margin_ + 8) * words_) {
    const int columns = margin_ / 8;
    for (int di = -columns; di <= columns; ++di)
        for (int dj = -columns; dj <= columns; ++dj) {
            const std::size_t other = bits.bins_.find(bits.bins_.columnI(column) + di, bits.bins_.columnJ(column) + dj);
            if (other == voxelize::PlanBins::kNone) continue;
            const std::uint64_t word = bits.bitsOf(other, below);
            if (word == 0) continue;
            // Eight bits never lie across two words.
            const int bit = 8 * dj + margin_;
            for (int x = 0; x < 8; ++x) row(8 * di + x)[bit / 64] |= (word >> (8 * x) & 0xffU) << (bit % 64);
        }
}

// From y to the nearest bit of a row; more than `most_` if there is none within.
int PlanBits::Window::steps(const std::uint64_t* row, int y) const {
    const int at = y + margin_;
    int up = most_ + 1;
    for (int word = at / 64; word < static_cast<int>(words_) && 64 * word - at <= most_; ++word) {
        const std::uint64_t bits = word == at / 64 ? row[word] >> (at % 64) << (at % 64) : row[word];
        if (bits == 0) continue;
        up = 64 * word + std::countr_zero(bits) - at;
        break;
    }
    int down = most_ + 1;
    for (int word = at / 64; word >= 0 && at - (64 * word + 63) <= most_; --word) {
        const int left = 63 - at % 64;
        const std::uint64_t bits = word == at / 64 ? row[word] << left >> left : row[word];
        if (bits == 0) continue;
        down = at - (64 * word + 63 - std::countl_zero(bits));
        break;
    }
    return std::min(up, down);
}

double PlanBits::Window::distance2(int x, int y) const {
    double least = std::numeric_limits<double>::infinity();
    for (int dx = -most_; dx <= most_; ++dx) {
        const int dy = steps(row(x + dx), y);
        if (dy <= most_) least = std::min(least, static_cast<double>(dx * dx + dy * dy));
    }
    return least;
}

}  // namespace stratum::report
