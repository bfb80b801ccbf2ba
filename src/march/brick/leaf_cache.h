// A thread's cache of recently converted leaves, because neighbouring bricks share leaves.
#pragma once

#include "base/huge_array.h"
#include "march/brick/brick_layout.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace stratum::march {

/// The eight leaves of one brick have distinct entries, and so have those of a macro cell and its neighbours.
template <typename T>
class LeafCache {
public:
    struct Entry {
        std::uint64_t key = 0;  // see keyOf()
        bool uniform = false;   // background, all of it
        LeafSamples<T> samples;
        CapSamples<T> above;  // of a field
    };
    static std::uint64_t keyOf(int x, int y, int z) {
        const auto part = [](int c) { return static_cast<std::uint64_t>(c) + 1; };
        return part(x) << 42 | part(y) << 21 | part(z);
    }
    Entry& at(int x, int y, int z) {
        return entries_[static_cast<std::size_t>((x & kLast) << (2 * kBits) | (y & kLast) << kBits | (z & kLast))];
    }
    /// An entry apart for each part of a brick (see BrickParts), of which only what the brick shares need be there.
    Entry& shared(std::size_t part) { return shared_[part]; }

private:
    static constexpr int kBits = 4;
    static constexpr int kLast = (1 << kBits) - 1;
    HugeArray<Entry> entries_{std::size_t{1} << (3 * kBits)};
    std::array<Entry, 4> shared_;
};

}  // namespace stratum::march
