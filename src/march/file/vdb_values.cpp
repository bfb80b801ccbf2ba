#include "march/file/vdb_values.h"

#include <blosc.h>
#include <openvdb/math/Half.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <type_traits>

namespace stratum::march {
namespace {

constexpr std::size_t kLeafValues = 512;

bool unzips(const VdbValues& values, void* out) {
    if (values.data.size() > std::numeric_limits<uLong>::max()) return false;
    auto length = static_cast<uLongf>(values.length);
    return ::uncompress(static_cast<Bytef*>(out), &length, reinterpret_cast<const Bytef*>(values.data.data()),
                        static_cast<uLong>(values.data.size())) == Z_OK &&
           length == values.length;
}

// To values.length bytes.
void unpackBytes(const VdbCursor& cursor, const VdbValues& values, std::uint32_t compression, void* out) {
    if (values.length == 0) return;
    if (!values.packed) {
        std::memcpy(out, values.data.data(), values.data.size());
        return;
    }
    const bool good = (compression & kVdbBlosc) != 0
                          ? blosc_decompress_ctx(values.data.data(), out, values.length, 1) ==
                                static_cast<std::int64_t>(values.length)
                          : unzips(values, out);
    if (!good) cursor.fail("packed data");
}

// Room for the values of a node; those of a leaf, which are by far the most, need no allocation.
template <typename T>
class Scratch {
public:
    explicit Scratch(std::size_t count) {
        if (count > near_.size()) far_ = std::make_unique_for_overwrite<T[]>(count);
    }
    T* data() { return far_ ? far_.get() : near_.data(); }

private:
    std::array<T, kLeafValues> near_;
    std::unique_ptr<T[]> far_;
};

// The values that are stored.
template <typename T>
void unpackStored(const VdbCursor& cursor, const VdbValues& values, const VdbValueFormat& format, T* out) {
    if (format.half == 0) {
        unpackBytes(cursor, values, format.compression, out);
        return;
    }
    if constexpr (!std::is_integral_v<T>) {
        constexpr std::size_t kComponents = openvdb::VecTraits<T>::Size;
        const std::size_t count = kComponents * static_cast<std::size_t>(values.stored);
        Scratch<std::array<std::uint16_t, kComponents>> halves(static_cast<std::size_t>(values.stored));
        unpackBytes(cursor, values, format.compression, halves.data());
        const auto* const from = reinterpret_cast<const std::uint16_t*>(halves.data());
        auto* const to = reinterpret_cast<float*>(out);
        for (std::size_t n = 0; n < count; ++n) {
            openvdb::math::half half;
            half.setBits(from[n]);
            to[n] = half;
        }
    }
}

// Unsigned for integers: the least of a damaged file has no opposite.
template <typename T>
T opposite(const T& value) {
    if constexpr (std::is_integral_v<T>)
        return static_cast<T>(0 - static_cast<std::make_unsigned_t<T>>(value));
    else
        return -value;
}

}  // namespace

template <typename T>
void unpackVdbValues(const VdbCursor& cursor, const VdbValues& values, const VdbValueFormat& format,
                     std::string_view active, const T& background, T* out) {
    const std::size_t count = active.size() * 8;
    if (values.stored == count) {
        unpackStored(cursor, values, format, out);
        return;
    }
    Scratch<T> stored(static_cast<std::size_t>(values.stored));
    unpackStored(cursor, values, format, stored.data());
    const T* next = stored.data();
    T inactive[2] = {values.kind == VdbValues::kBackground ? background : opposite(background), background};
    std::memcpy(static_cast<void*>(inactive), values.inactive.data(), values.inactive.size());
    for (std::size_t word = 0; word < count / 64; ++word) {
        const std::uint64_t mask = wordOf(active, word);
        const std::uint64_t which = values.chosen.empty() ? 0 : wordOf(values.chosen, word);
        for (std::size_t row = 0; row < 64; row += 8) {
            const std::uint64_t on = mask >> row & 0xff;
            T* const row_to = out + 64 * word + row;
            if (on == 0xff) {
                std::copy_n(next, 8, row_to);
                next += 8;
                continue;
            }
            for (std::size_t bit = 0; bit < 8; ++bit) row_to[bit] = inactive[which >> (row + bit) & 1];
            for (std::uint64_t rest = on; rest != 0; rest &= rest - 1) row_to[std::countr_zero(rest)] = *next++;
        }
    }
}

template void unpackVdbValues(const VdbCursor&, const VdbValues&, const VdbValueFormat&, std::string_view, const float&,
                              float*);
template void unpackVdbValues(const VdbCursor&, const VdbValues&, const VdbValueFormat&, std::string_view,
                              const std::int32_t&, std::int32_t*);
template void unpackVdbValues(const VdbCursor&, const VdbValues&, const VdbValueFormat&, std::string_view,
                              const openvdb::Vec3f&, openvdb::Vec3f*);

}  // namespace stratum::march
