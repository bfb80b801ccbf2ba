// A bounds-checked cursor over bytes in memory, for readers of untrusted formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace stratum {

/// The base of a format's cursor. `Format` derives from it and has `[[noreturn]] void endsEarly() const`, which throws
/// with the format's own message. Numbers are in native byte order.
template <typename Format>
class ByteCursor {
public:
    explicit ByteCursor(std::string_view bytes) : bytes_(bytes) {}

    std::uint64_t offset() const { return offset_; }
    /// Called before bytes are given: for formats that are read where the cursor goes.
    void load(std::size_t /*offset*/, std::size_t /*count*/) const {}
    bool done() const { return offset_ == bytes_.size(); }
    std::string_view take(std::uint64_t count) {
        if (count > bytes_.size() - offset_) static_cast<const Format&>(*this).endsEarly();
        static_cast<const Format&>(*this).load(offset_, static_cast<std::size_t>(count));
        const std::string_view taken = bytes_.substr(offset_, static_cast<std::size_t>(count));
        offset_ += static_cast<std::size_t>(count);
        return taken;
    }
    template <typename T>
    T read() {
        T value;
        read(&value, 1);
        return value;
    }
    template <typename T>
    void read(T* out, std::size_t count) {
        std::memcpy(out, take(count * sizeof(T)).data(), count * sizeof(T));
    }

protected:
    std::string_view bytes_;
    std::size_t offset_ = 0;  // at most bytes_.size()
};

}  // namespace stratum
