// Numbers the squares of the plan that are used, however far apart they lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::voxelize {

/// Rounded down: the square of edge b in which a lies.
constexpr int floorDivide(int a, int b) { return a / b - (a % b < 0 ? 1 : 0); }

/// A hash table of places (x, y). Memory is in proportion to the squares that were added.
class PlanIndex {
public:
    static constexpr std::uint32_t kNone = 0xffffffff;
    struct Square {
        int x = 0, y = 0;
        bool operator==(const Square&) const = default;
    };

    /// The number of a square, or kNone.
    std::uint32_t find(int x, int y) const {
        if (table_.empty()) return kNone;
        return table_[slotOf({x, y})];
    }
    /// The same; one that is not there gets the next number.
    std::uint32_t add(int x, int y) {
        if (2 * (squares_.size() + 1) > table_.size()) grow();
        std::uint32_t& number = table_[slotOf({x, y})];
        if (number == kNone) {
            number = static_cast<std::uint32_t>(squares_.size());
            squares_.push_back({x, y});
        }
        return number;
    }
    std::size_t size() const { return squares_.size(); }
    /// By number.
    const std::vector<Square>& squares() const { return squares_; }
    std::size_t bytes() const { return squares_.capacity() * sizeof(Square) + table_.capacity() * sizeof(table_[0]); }

private:
    // Where the square is, or would be: the table is at most half full.
    std::size_t slotOf(const Square& square) const {
        const std::uint64_t key = static_cast<std::uint64_t>(static_cast<std::uint32_t>(square.x)) << 32 |
                                  static_cast<std::uint32_t>(square.y);
        const std::uint64_t mixed = (key ^ key >> 32) * 0x9e3779b97f4a7c15U;
        std::size_t slot = static_cast<std::size_t>(mixed >> 32) & (table_.size() - 1);
        while (table_[slot] != kNone && squares_[table_[slot]] != square) slot = (slot + 1) & (table_.size() - 1);
        return slot;
    }
    void grow() {
        constexpr std::size_t kFewest = 16;
        table_.assign(table_.empty() ? kFewest : 2 * table_.size(), kNone);
        for (std::size_t n = 0; n < squares_.size(); ++n) table_[slotOf(squares_[n])] = static_cast<std::uint32_t>(n);
    }

    std::vector<Square> squares_;
    std::vector<std::uint32_t> table_;  // a power of two
};

}  // namespace stratum::voxelize
