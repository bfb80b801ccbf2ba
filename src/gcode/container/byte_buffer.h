// A growing buffer that is neither cleared nor, when large, copied: realloc moves pages, not bytes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <string_view>
#include <utility>

namespace stratum::gcode {

/// Growing bytes for decoders. Movable, not copyable; a view survives a move, but not growth. Throws std::bad_alloc.
class ByteBuffer {
public:
    ByteBuffer() = default;
    ByteBuffer(ByteBuffer&& other) noexcept { *this = std::move(other); }
    ByteBuffer& operator=(ByteBuffer&& other) noexcept {
        data_ = std::move(other.data_);
        size_ = std::exchange(other.size_, 0);
        capacity_ = std::exchange(other.capacity_, 0);
        return *this;
    }

    std::size_t size() const { return size_; }
    /// Bytes that extend() can give without growing.
    std::size_t spare() const { return capacity_ - size_; }
    std::string_view view() const { return {data_.get(), size_}; }

    void reserve(std::size_t capacity) {
        if (capacity <= capacity_) return;
        void* grown = std::realloc(data_.get(), capacity);
        if (grown == nullptr) throw std::bad_alloc();
        static_cast<void>(data_.release());
        data_.reset(static_cast<char*>(grown));
        capacity_ = capacity;
    }

    /// Appends `count` uninitialized bytes and returns a pointer to them.
    char* extend(std::size_t count) {
        if (count > capacity_ - size_) reserve(std::max(size_ + count, capacity_ + capacity_ / 2));
        char* start = data_.get() + size_;
        size_ += count;
        return start;
    }

    void append(std::string_view bytes) {
        if (!bytes.empty()) std::copy(bytes.begin(), bytes.end(), extend(bytes.size()));
    }

    /// Truncates to `size` bytes; size <= size().
    void truncate(std::size_t size) { size_ = size; }

private:
    struct Free {
        void operator()(char* data) const { std::free(data); }
    };
    std::unique_ptr<char, Free> data_;
    std::size_t size_ = 0;
    std::size_t capacity_ = 0;
};

}  // namespace stratum::gcode
