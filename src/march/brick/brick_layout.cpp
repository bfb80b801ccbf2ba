#include "march/brick/brick_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "march/brick/brick_layout.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stratum::march {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, LeafSource::kLeafEdge>;
using Whole = hn::RebindToSigned<Floats>;

HWY_INLINE void store(hn::Vec<Floats> v, float, float* out) { hn::StoreU(v, Floats(), out); }

HWY_INLINE void store(hn::Vec<Floats> v, float scale, std::int16_t* out) {
    const Floats d;
    const Whole di;
    const auto most = hn::Set(d, static_cast<float>(kMostQuanta));
    const auto quanta = hn::NearestInt(hn::Min(hn::Max(v * hn::Set(d, scale), hn::Neg(most)), most));
    const auto below = hn::RebindMask(di, hn::Lt(v, hn::Zero(d)));
    const auto kept = hn::IfThenElse(below, quanta - hn::Set(di, 1), quanta);
    const hn::Rebind<std::int16_t, Whole> narrow;
    hn::StoreU(hn::DemoteTo(narrow, kept), narrow, out);
}

// 64 samples. `inside` gets a bit for each that is below zero. False if one is no finite number.
template <typename T>
HWY_INLINE bool convertSlab(const float* samples, float scale, T* out, std::uint64_t& inside) {
    const Floats d;
    const auto largest = hn::Set(d, std::numeric_limits<float>::max());
    auto finite = hn::Eq(largest, largest);
    inside = 0;
    for (std::size_t n = 0; n < 64; n += hn::Lanes(d)) {
        const auto v = hn::LoadU(d, samples + n);
        finite = hn::And(finite, hn::Le(hn::Abs(v), largest));
        store(v, scale, out + n);
        alignas(8) std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Lt(v, hn::Zero(d)), bits);
        inside |= static_cast<std::uint64_t>(bits[0]) << n;
    }
    return hn::AllTrue(d, finite);
}

template <typename T>
bool convertAll(const float* samples, float scale, LeafSamples<T>& out) {
    bool finite = true;
    for (std::size_t x = 0; x < out.inside.size(); ++x)
        finite &= convertSlab(samples + 64 * x, scale, out.value.data() + 64 * x, out.inside[x]);
    return finite;
}

template <typename T>
bool convertCap(const float* samples, float scale, CapSamples<T>& out) {
    std::uint64_t inside = 0;
    const bool finite = convertSlab(samples, scale, out.value.data(), inside);
    // The eight bits of an x, spread to the lowest of eight bytes: first into the byte of their number.
    for (std::size_t x = 0; x < out.inside.size(); ++x) {
        const std::uint64_t spread = (inside >> (8 * x) & 0xff) * 0x0101010101010101 & 0x8040201008040201;
        out.inside[x] = (spread + 0x7f7f7f7f7f7f7f7f) >> 7 & 0x0101010101010101;
    }
    return finite;
}

bool convertFloats(const float* samples, float scale, LeafSamples<float>& out) {
    return convertAll(samples, scale, out);
}
bool convertQuanta(const float* samples, float scale, LeafSamples<std::int16_t>& out) {
    return convertAll(samples, scale, out);
}
bool convertFloatCap(const float* samples, float scale, CapSamples<float>& out) {
    return convertCap(samples, scale, out);
}
bool convertQuantaCap(const float* samples, float scale, CapSamples<std::int16_t>& out) {
    return convertCap(samples, scale, out);
}

}  // namespace HWY_NAMESPACE
}  // namespace stratum::march
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::march {
namespace {

constexpr int kEdge = LeafSource::kLeafEdge;
constexpr int kSamples = kEdge + 1;
constexpr std::uint64_t kColumn = 0x0101010101010101;  // z = 0 of all y

}  // namespace

HWY_EXPORT(convertFloats);
HWY_EXPORT(convertQuanta);
HWY_EXPORT(convertFloatCap);
HWY_EXPORT(convertQuantaCap);

bool convert(const float* samples, float scale, LeafSamples<float>& out) {
    return HWY_DYNAMIC_DISPATCH(convertFloats)(samples, scale, out);
}
bool convert(const float* samples, float scale, LeafSamples<std::int16_t>& out) {
    return HWY_DYNAMIC_DISPATCH(convertQuanta)(samples, scale, out);
}

bool convert(const float* samples, float scale, CapSamples<float>& out) {
    return HWY_DYNAMIC_DISPATCH(convertFloatCap)(samples, scale, out);
}
bool convert(const float* samples, float scale, CapSamples<std::int16_t>& out) {
    return HWY_DYNAMIC_DISPATCH(convertQuantaCap)(samples, scale, out);
}

float convert(float sample, float, float) { return sample; }

std::int16_t convert(float sample, float scale, std::int16_t) {
    constexpr float kMost = kMostQuanta;
    const float quanta = std::nearbyint(std::clamp(sample * scale, -kMost, kMost));
    return static_cast<std::int16_t>(sample < 0 ? quanta - 1.0F : quanta);
}

template <typename T>
CellBits surfaceOf(const BrickParts<T>& parts) {
    const auto slab = [&parts](std::size_t part, std::size_t x) {
        if (parts.leaf[part] != nullptr) return parts.leaf[part]->inside[x];
        return parts.tile[part] < 0 ? ~std::uint64_t{0} : std::uint64_t{0};
    };
    const auto above = [&parts](std::size_t part, std::size_t x) {
        if (parts.cap[part].inside != nullptr) return parts.cap[part].inside[x];
        return parts.cap_tile[part] < 0 ? ~std::uint64_t{0} : std::uint64_t{0};
    };
    // Of the cells between two slabs of samples, at their lower and upper x: whether any, and whether all, of the four
    // corners there are inside.
    std::array<std::uint64_t, kSamples> any{};
    std::array<std::uint64_t, kSamples> all{};
    for (std::size_t x = 0; x < kSamples; ++x) {
        const std::size_t far = x == kEdge ? 2 : 0;
        const std::size_t from = x == kEdge ? 0 : x;
        const std::uint64_t here = slab(far, from);
        const std::uint64_t at_z = above(far, from);
        const std::uint64_t at_y = slab(far | 1, from);
        const std::uint64_t at_yz = above(far | 1, from);
        const auto alongZ = [](std::uint64_t rows, std::uint64_t next) {
            return (rows >> 1 & ~(kColumn << 7)) | (next & kColumn) << 7;
        };
        const auto alongY = [](std::uint64_t rows, std::uint64_t next) { return rows >> 8 | next << 56; };
        const std::uint64_t z = alongZ(here, at_z);
        const std::uint64_t y = alongY(here, at_y);
        const std::uint64_t yz = alongY(z, alongZ(at_y, at_yz));
        any[x] = here | z | y | yz;
        all[x] = here & z & y & yz;
    }
    CellBits surface{};
    for (std::size_t x = 0; x < kEdge; ++x) {
        const std::uint64_t mixed = (any[x] | any[x + 1]) & ~(all[x] & all[x + 1]);
        for (std::size_t part = 0; part < 4; ++part) {
            // Four rows of four bits each, eight apart, moved together.
            std::uint64_t bits = mixed >> (32 * (part >> 1) + 4 * (part & 1)) & 0x0f0f0f0f;
            bits = (bits | bits >> 4) & 0x00ff00ff;
            bits = (bits | bits >> 8) & 0xffff;
            surface[(x >> 2) << 2 | part] |= bits << (16 * (x & 3));
        }
    }
    return surface;
}

template <typename T>
void layOut(const BrickParts<T>& parts, T* out) {
    for (std::size_t x = 0; x < kSamples; ++x)
        for (std::size_t y = 0; y < kSamples; ++y) {
            const std::size_t part = (x == kEdge ? 2U : 0U) | (y == kEdge ? 1U : 0U);
            const std::size_t column = x % kEdge * kEdge + y % kEdge;
            const std::size_t row = column * kEdge;
            // Lengths known to the compiler: a call to copy a row costs more than the copy.
            if (const LeafSamples<T>* leaf = parts.leaf[part]; leaf != nullptr)
                std::copy_n(leaf->value.data() + row, kEdge, out);
            else
                std::fill_n(out, kEdge, parts.tile[part]);
            const Cap<T>& cap = parts.cap[part];
            out[kEdge] = cap.value != nullptr ? cap.value[column * cap.stride] : parts.cap_tile[part];
            out += kSamples;
        }
}

template <typename T>
void copyShared(const T* brick, std::size_t part, LeafSamples<T>& leaf, CapSamples<T>& above) {
    const std::size_t count_x = (part & 2) != 0 ? 1 : kEdge;
    const std::size_t count_y = (part & 1) != 0 ? 1 : kEdge;
    for (std::size_t x = 0; x < count_x; ++x) {
        leaf.inside[x] = above.inside[x] = 0;
        for (std::size_t y = 0; y < count_y; ++y) {
            const T* row = brick + (x * kSamples + y) * kSamples;
            const std::size_t column = x * kEdge + y;
            std::copy_n(row, kEdge, leaf.value.data() + column * kEdge);
            above.value[column] = row[kEdge];
            std::uint64_t inside = 0;
            for (std::size_t z = 0; z < kEdge; ++z) inside |= static_cast<std::uint64_t>(row[z] < 0) << z;
            leaf.inside[x] |= inside << (8 * y);
            above.inside[x] |= static_cast<std::uint64_t>(row[kEdge] < 0) << (8 * y);
        }
    }
}

template CellBits surfaceOf(const BrickParts<float>&);
template CellBits surfaceOf(const BrickParts<std::int16_t>&);
template void layOut(const BrickParts<float>&, float*);
template void layOut(const BrickParts<std::int16_t>&, std::int16_t*);
template void copyShared(const float*, std::size_t, LeafSamples<float>&, CapSamples<float>&);
template void copyShared(const std::int16_t*, std::size_t, LeafSamples<std::int16_t>&, CapSamples<std::int16_t>&);

}  // namespace stratum::march
#endif
