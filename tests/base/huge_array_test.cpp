#include "base/huge_array.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace stratum {
namespace {

using Quanta = HugeArray<std::int16_t>;

constexpr std::uintptr_t kPage = 4096;

std::uintptr_t pageAfter(const std::int16_t* end) {
    return (reinterpret_cast<std::uintptr_t>(end) + kPage - 1) / kPage * kPage;
}

/// A page that nobody may read, where a mapping ends. Null if something else is there.
void* guardAt(std::uintptr_t address) {
    void* page = mmap(reinterpret_cast<void*>(address), kPage, PROT_NONE,
                      MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED_NOREPLACE, -1, 0);
    return page == MAP_FAILED ? nullptr : page;
}

// The z-pair at a brick's last cell begins two samples before its end and is gathered as eight bytes. 663 bricks and
// one sample fill their pages to the last byte.
TEST(HugeArray, AGatherOfEightBytesAtTheLastSamplesStaysInTheMapping) {
    constexpr std::size_t kSize = 663 * std::size_t{9 * 9 * 9};  // samples of 663 bricks
    static_assert((kSize + 1) * sizeof(std::int16_t) % kPage == 0);
    // New mappings mostly lie right below the one before: that one makes room for the guard.
    std::vector<std::unique_ptr<Quanta>> arrays;
    void* guard = nullptr;
    const Quanta* guarded = nullptr;
    for (int n = 0; n < 64 && guard == nullptr; ++n) {
        arrays.push_back(std::make_unique<Quanta>(kSize));
        guarded = arrays.back().get();
        // One page later if the spare bytes have one of their own.
        const std::uintptr_t end = pageAfter(guarded->data() + kSize + 1);
        for (const std::uintptr_t place : {end, end + kPage}) {
            for (std::size_t i = 0; i + 1 < arrays.size(); ++i)
                if (arrays[i] && reinterpret_cast<std::uintptr_t>(arrays[i]->data()) == place) arrays[i].reset();
            guard = guardAt(place);
            if (guard != nullptr) break;
        }
    }
    ASSERT_NE(guard, nullptr);
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    // The system refuses to copy what may not be read, where a load would end the program.
    EXPECT_EQ(::write(ends[1], guarded->data() + kSize - 2, 8), 8) << "the read reaches the page behind the mapping";
    (void)close(ends[0]);
    (void)close(ends[1]);
    (void)munmap(guard, kPage);
}

}  // namespace
}  // namespace stratum
