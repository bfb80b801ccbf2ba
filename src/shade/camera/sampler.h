// Quasi-random numbers as a pure function of pixel, sample, dimension and seed.
//
// Owen-scrambled Sobol' points, padded: every draw is its own (0,2)-sequence in one or two dimensions, shuffled and
// scrambled by hashes. Any power-of-two prefix of a pixel's samples is a stratified set in every draw.
// Sources: B. Burley, "Practical Hash-based Owen Scrambling", JCGT 9(4) 2020; the permutation is N. Vegdahl's improved
// Laine-Karras hash (https://psychopath.io/post/2021_01_30_building_a_better_lk_hash), as in pbrt-v4; the second
// dimension by A. Ahmed, "An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact", EGSR 2024.
#pragma once

#include <glm/vec2.hpp>

#include <bit>
#include <cstdint>

namespace stratum::shade {

namespace sobol {

inline std::uint32_t reverseBits(std::uint32_t v) {
    v = __builtin_bswap32(v);
    v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    return ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
}

/// A hash of good avalanche (C. Wellons' lowbias32).
inline std::uint32_t hash(std::uint32_t v) {
    v ^= v >> 16;
    v *= 0x7feb352du;
    v ^= v >> 15;
    v *= 0x846ca68bu;
    return v ^ (v >> 16);
}

inline std::uint32_t hash(std::uint32_t a, std::uint32_t b) {
    return hash(a ^ (hash(b) + 0x9e3779b9u + (a << 6) + (a >> 2)));
}

/// Every bit is flipped by a hash of the bits above it: a nested uniform (Owen) scramble in base 2.
inline std::uint32_t owenScramble(std::uint32_t v, std::uint32_t seed) {
    v = reverseBits(v);
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return reverseBits(v);
}

/// The two dimensions of Sobol's (0,2)-sequence as 32-bit fractions.
inline std::uint32_t dimension0(std::uint32_t index) { return reverseBits(index); }
inline std::uint32_t dimension1(std::uint32_t index) {
    // Multiplication by Pascal's triangle mod 2, one power-of-two band at a time.
    index ^= index >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xaaaaaaaau) >> 1;
    return reverseBits(index);
}

/// A 32-bit fraction as a float in [0, 1).
inline float toFloat(std::uint32_t v) { return static_cast<float>(v >> 8) * 0x1p-24f; }

}  // namespace sobol

/// The numbers of one sample of one pixel, in the order in which they are drawn. Not shared between threads; cheap.
///
/// The pixels of a 64 x 64 block use consecutive parts of one sequence along a Z-curve, so that the samples of
/// neighbouring pixels complement each other and the remaining error is blue noise: A. Ahmed, P. Wonka, "Screen-Space
/// Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels", SIGGRAPH Asia 2020.
class Sampler {
public:
    /// @param seed  selects the sequence
    /// @param spp   samples that a pixel will take, 1 to 65536; more than that repeat the neighbours' numbers
    Sampler(std::uint32_t seed, std::uint32_t spp)
        : seed_(sobol::hash(seed, 0x5eedu)), stretch_(static_cast<unsigned>(std::bit_width(spp > 1 ? spp - 1 : 0u))) {}

    /// Begins a sample. The same arguments give the same draws.
    void start(int x, int y, std::uint32_t sample) {
        const auto ux = static_cast<std::uint32_t>(x);
        const auto uy = static_cast<std::uint32_t>(y);
        block_ = sobol::hash(sobol::hash(seed_, ux / kBlock), uy / kBlock);
        index_ = ((spread(ux % kBlock) | (spread(uy % kBlock) << 1)) << stretch_) + sample;
        draw_ = 0;
    }

    /// Skips a draw, of one dimension or of two.
    void skip() { ++draw_; }
    /// State of the next draw: draws of one block differ by index alone, those of one index by block.
    std::uint32_t block() const { return block_; }
    std::uint32_t index() const { return index_; }
    std::uint32_t draw() const { return draw_; }

    /// Begins the next sample of the same pixel.
    void startNext() {
        ++index_;
        draw_ = 0;
    }
    /// Uniform in [0, 1).
    float next1D() {
        const std::uint32_t key = sobol::hash(block_, draw_++);
        const std::uint32_t index = sobol::owenScramble(index_, key);
        return sobol::toFloat(sobol::owenScramble(sobol::dimension0(index), sobol::hash(key, 1u)));
    }

    /// Uniform in [0, 1)^2.
    glm::vec2 next2D() {
        const std::uint32_t key = sobol::hash(block_, draw_++);
        const std::uint32_t index = sobol::owenScramble(index_, key);
        return {sobol::toFloat(sobol::owenScramble(sobol::dimension0(index), sobol::hash(key, 1u))),
                sobol::toFloat(sobol::owenScramble(sobol::dimension1(index), sobol::hash(key, 2u)))};
    }

private:
    static constexpr std::uint32_t kBlock = 64;  // 12 bits of pixels and 16 of samples fit an index

    /// Six bits, each followed by a gap.
    static std::uint32_t spread(std::uint32_t v) {
        v = (v | (v << 4)) & 0x0f0fu;
        v = (v | (v << 2)) & 0x3333u;
        return (v | (v << 1)) & 0x5555u;
    }

    std::uint32_t seed_;
    unsigned stretch_;
    std::uint32_t block_ = 0;
    std::uint32_t index_ = 0;
    std::uint32_t draw_ = 0;
};

}  // namespace stratum::shade
