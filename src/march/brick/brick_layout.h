// Leaves -> one brick: its surface cells, and the samples at all corners.
#pragma once

#include "march/file/leaf_source.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace stratum::march {

/// How bricks keep samples.
enum class BrickValues {
    Float32,  ///< as the grid has them, world units
    Int16,    ///< whole multiples of a 32767th of the narrow band's half-width; signs stay exact, see sampleOf()
};

/// Of Int16, half of the band: a sample at its edge.
inline constexpr int kMostQuanta = 32767;
/// Of Int16, a sample between zero and half a quantum below it: inside, almost on the surface. By rounding of floats,
/// flats on voxel planes have such samples everywhere; a whole quantum would displace them.
inline constexpr double kLeastInside = -1.0 / 1024;

/// The value, in quanta, of a stored sample. Values below zero are stored one lower, so that -1 means kLeastInside.
constexpr double sampleOf(std::int16_t kept) { return kept < 0 ? (kept == -1 ? kLeastInside : kept + 1) : kept; }
constexpr double sampleOf(float kept) { return static_cast<double>(kept); }

/// The samples of a leaf as bricks keep them, x slowest, and which of them are inside (below zero; zero is outside):
/// bit 8 y + z of word x.
template <typename T>
struct LeafSamples {
    std::array<T, LeafSource::kLeafSamples> value;
    std::array<std::uint64_t, 8> inside;
};

/// The same of the plane of 8^2 samples above a leaf: x slowest; bit 8 y of word x.
template <typename T>
struct CapSamples {
    std::array<T, LeafSource::kCapSamples> value;
    std::array<std::uint64_t, 8> inside;
};

/// Converts 512 samples in world units. `scale` is in quanta a world unit; floats are kept and it is ignored. Nearest
/// quantum, and samples below zero stay below zero; samples beyond the band are clamped. Returns false if one is not
/// finite.
bool convert(const float* samples, float scale, LeafSamples<float>& out);
bool convert(const float* samples, float scale, LeafSamples<std::int16_t>& out);
/// The same of 64.
bool convert(const float* samples, float scale, CapSamples<float>& out);
bool convert(const float* samples, float scale, CapSamples<std::int16_t>& out);
/// One sample.
float convert(float sample, float scale, float);
std::int16_t convert(float sample, float scale, std::int16_t);

/// The plane of samples above a leaf, in the next leaf or by itself.
template <typename T>
struct Cap {
    const T* value = nullptr;
    std::size_t stride = 1;                 ///< from one (x, y) to the next, y fastest
    const std::uint64_t* inside = nullptr;  ///< 8 words; only bits 8 y count

    Cap() = default;
    explicit Cap(const LeafSamples<T>& next)
        : value(next.value.data()), stride(LeafSource::kLeafEdge), inside(next.inside.data()) {}
    explicit Cap(const CapSamples<T>& cap) : value(cap.value.data()), inside(cap.inside.data()) {}
};

/// The sources of a brick's 9^3 samples: the leaf itself and its neighbours at +x and +y, index x << 1 | y, and the
/// plane above each. Where there is none, all samples have the tile's value.
template <typename T>
struct BrickParts {
    std::array<const LeafSamples<T>*, 4> leaf{};
    std::array<T, 4> tile{};
    std::array<Cap<T>, 4> cap{};
    std::array<T, 4> cap_tile{};
    /// Neighbours without whose samples the surface cells are known: the tiles have their sign. See NeighborSigns.
    std::array<bool, 4> assumed{};
};

/// A bit for each of 8^3 cells: Mask64 of each 4^3 of them, x slowest.
using CellBits = std::array<std::uint64_t, 8>;

/// The cells whose corners are not of one sign.
template <typename T>
CellBits surfaceOf(const BrickParts<T>& parts);
/// Writes 9^3 samples, x slowest.
template <typename T>
void layOut(const BrickParts<T>& parts, T* out);
/// Of a brick that is laid out, the samples that the brick before it shares, as those of its leaf: `part` as in
/// BrickParts, 2 is the plane of x = 0, 1 that of y = 0, 3 where both are 0. Others are not written.
template <typename T>
void copyShared(const T* brick, std::size_t part, LeafSamples<T>& leaf, CapSamples<T>& above);

}  // namespace stratum::march
