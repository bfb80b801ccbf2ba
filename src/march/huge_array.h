// Memory for large tables that are read at random: on huge pages where the system has them, so that a ray's reads don't
// also miss the page tables, and not touched before it is filled, so that all threads share that work.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace stratum::march {

/// A fixed number of T, uninitialized, aligned to a cache line or better. One more than asked for is there, so that
/// vector code may read a little past the end, and index 0 always.
template <typename T>
class HugeArray {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
    HugeArray() = default;
    explicit HugeArray(std::size_t size) : size_(size) {
        constexpr std::size_t kHugePage = std::size_t{1} << 21;
        constexpr std::size_t kCacheLine = 64;
        const std::size_t wanted = (size + 1) * sizeof(T);
        const std::size_t alignment = wanted < kHugePage ? kCacheLine : kHugePage;
        const std::size_t bytes = (wanted + alignment - 1) / alignment * alignment;
        void* memory = std::aligned_alloc(alignment, bytes);
        if (memory == nullptr) throw std::bad_alloc();
        // Only advice: what it returns changes nothing.
        if (alignment == kHugePage) (void)madvise(memory, bytes, MADV_HUGEPAGE);
        data_.reset(static_cast<T*>(memory));
        data_.get()[size] = T{};
        bytes_ = bytes;
    }

    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    T& operator[](std::size_t n) { return data_.get()[n]; }
    const T& operator[](std::size_t n) const { return data_.get()[n]; }
    T* begin() { return data(); }
    T* end() { return data() + size_; }
    std::size_t size() const { return size_; }
    /// Memory taken.
    std::size_t bytes() const { return bytes_; }

private:
    struct Free {
        void operator()(T* memory) const { std::free(memory); }
    };
    std::unique_ptr<T, Free> data_;
    std::size_t size_ = 0, bytes_ = 0;
};

}  // namespace stratum::march
