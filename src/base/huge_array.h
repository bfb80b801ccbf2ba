// Memory for large tables with random access: on huge pages if the system has them, to avoid TLB misses. It is zero,
// and physical pages are allocated on first touch: parts that are never written need no memory, and all threads share
// the work of the first touch.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <type_traits>

namespace stratum {

/// A fixed number of T, all bits zero, aligned to a cache line or better. It is padded by one T and kReadAhead bytes of
/// zeros: vector code may read that many bytes from any element on, and index 0 is always valid.
template <typename T>
class HugeArray {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
    /// The size of pages: small ones for tables of which only scattered parts are written.
    enum class Pages { huge, small };
    /// Bytes that one lane of a gather reads, for any T.
    static constexpr std::size_t kReadAhead = 8;

    HugeArray() = default;
    /// Throws std::bad_alloc if the address space is exhausted.
    explicit HugeArray(std::size_t size, Pages pages = Pages::huge) : size_(size) {
        constexpr std::size_t kHugePage = std::size_t{1} << 21;
        const std::size_t wanted = (size + 1) * sizeof(T) + kReadAhead;
        const bool large = wanted >= kHugePage;
        // Maps are aligned to small pages; the unused part of a longer one is never touched.
        const std::size_t mapped = large ? wanted + kHugePage : wanted;
        void* memory =
            mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (memory == MAP_FAILED) throw std::bad_alloc();
        map_ = {static_cast<std::byte*>(memory), Unmap{mapped}};
        if (large) {
            const auto address = reinterpret_cast<std::uintptr_t>(memory);
            const std::size_t skipped = (kHugePage - address % kHugePage) % kHugePage;
            data_ = reinterpret_cast<T*>(map_.get() + skipped);
            // Only advice: failure has no effect.
            (void)madvise(data_, wanted, pages == Pages::huge ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
        } else {
            data_ = reinterpret_cast<T*>(map_.get());
        }
    }

    T* data() { return data_; }
    const T* data() const { return data_; }
    T& operator[](std::size_t n) { return data_[n]; }
    const T& operator[](std::size_t n) const { return data_[n]; }
    T* begin() { return data_; }
    T* end() { return data_ + size_; }
    std::size_t size() const { return size_; }

private:
    struct Unmap {
        std::size_t length = 0;
        void operator()(std::byte* memory) const { (void)munmap(memory, length); }
    };
    std::unique_ptr<std::byte, Unmap> map_;
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace stratum
