// Leaves -> one brick: which of its cells have surface, and the samples at all their corners.
#pragma once

#include "march/leaf_source.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace stratum::march {

/// How bricks keep samples.
enum class BrickValues {
    Float32,  ///< as the grid has them, world units
    Int16,    ///< whole multiples of a 32767th of the narrow band's half-width; signs stay exact
};

/// Of Int16, half of the band: a sample at its edge.
inline constexpr int kMostQuanta = 32767;

/// The samples of a leaf as bricks keep them, x slowest, and which of them are inside (below zero; zero is outside):
/// bit 8 y + z of word x.
template <typename T>
struct LeafSamples {
    std::array<T, LeafSource::kLeafSamples> value;
    std::array<std::uint64_t, 8> inside;
};

/// Converts 512 samples in world units. `scale` is in quanta a world unit; floats are kept and it is ignored. Nearest
/// quantum, but samples below zero stay below zero; what is beyond the band is put at its edge. Returns false if one is
/// no finite number.
bool convert(const float* samples, float scale, LeafSamples<float>& out);
bool convert(const float* samples, float scale, LeafSamples<std::int16_t>& out);
/// One sample.
float convert(float sample, float scale, float);
std::int16_t convert(float sample, float scale, std::int16_t);

/// What a brick's 9^3 samples are taken from: the leaf itself, which there is, and its neighbours at +x, +y and +z,
/// index x << 2 | y << 1 | z. Where there is none, all samples are `tile`.
template <typename T>
struct BrickParts {
    std::array<const LeafSamples<T>*, 8> leaf{};
    std::array<T, 8> tile{};
};

/// A bit for each of 8^3 cells: Mask64 of each 4^3 of them, x slowest.
using CellBits = std::array<std::uint64_t, 8>;

/// The cells whose corners are not of one sign.
template <typename T>
CellBits surfaceOf(const BrickParts<T>& parts);
/// Writes 9^3 samples, x slowest.
template <typename T>
void layOut(const BrickParts<T>& parts, T* out);

}  // namespace stratum::march
