#include "shade/post/denoise_block.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shade/post/denoise_block.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef STRATUM_DENOISE_BLOCK_TYPES
#define STRATUM_DENOISE_BLOCK_TYPES
namespace stratum::shade {
namespace {

struct Neighbor {
    int dx, dy;
};

/// Those of a disc, row by row.
const std::vector<Neighbor>& neighbors() {
    static const std::vector<Neighbor> all = [] {
        std::vector<Neighbor> disc;
        constexpr int r = Denoising::kRadius;
        for (int dy = -r; dy <= r; ++dy)
            for (int dx = -r; dx <= r; ++dx)
                if (dx * dx + dy * dy <= r * (r + 1)) disc.push_back({dx, dy});
        return disc;
    }();
    return all;
}

constexpr std::size_t kWidth = DenoisePlanes::kBlockWidth;
constexpr std::size_t kHeight = DenoisePlanes::kBlockHeight;
constexpr std::size_t kArea = kWidth * kHeight;
constexpr std::size_t kPatchSide = 2 * std::size_t{Denoising::kPatch} + 1;
constexpr std::size_t kTall = kHeight + kPatchSide - 1;
constexpr std::size_t kWide = kWidth + 16;  // whole vectors
static_assert(kPatchSide - 1 <= 16);

/// The unknowns: slopes of position and terms, and the constant, which is last, so that back substitution computes it
/// first.
constexpr std::size_t kSlopes = 2 + std::size_t{DenoisePlanes::kTerms};
constexpr std::size_t kUnknowns = kSlopes + 1;

}  // namespace
}  // namespace stratum::shade
#endif

HWY_BEFORE_NAMESPACE();
namespace stratum::shade {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using V = hn::Vec<F>;

/// Distances of the light of all pixels, with a patch's rim, from that of their neighbours.
void lightDistances(const DenoisePlanes& in, int x0, int y0, const Neighbor& to, float* distances) {
    const F f;
    const auto tiny = hn::Set(f, 1e-10f);
    const auto k2 = hn::Set(f, Denoising::kLight * Denoising::kLight);
    for (std::size_t y = 0; y < kTall; ++y) {
        const int row = y0 + static_cast<int>(y) - Denoising::kPatch;
        const int column = x0 - Denoising::kPatch;
        const float* lp = in.at(DenoisePlanes::brightness, column, row);
        const float* vp = in.at(DenoisePlanes::variance, column, row);
        const float* lq = in.at(DenoisePlanes::brightness, column + to.dx, row + to.dy);
        const float* vq = in.at(DenoisePlanes::variance, column + to.dx, row + to.dy);
        for (std::size_t x = 0; x < kWidth + kPatchSide - 1; x += hn::Lanes(f)) {
            const auto d = hn::LoadU(f, lp + x) - hn::LoadU(f, lq + x);
            const auto a = hn::LoadU(f, vp + x);
            const auto b = hn::LoadU(f, vq + x);
            const auto beyond = hn::MulSub(d, d, a + hn::Min(a, b));
            hn::StoreU(beyond / hn::MulAdd(k2, a + b, tiny), f, distances + y * kWide + x);
        }
    }
}

/// The weights of one neighbour of all pixels.
void weigh(const DenoisePlanes& in, int x0, int y0, const Neighbor& to, float* weights) {
    const F f;
    HWY_ALIGN float distances[kTall * kWide];
    HWY_ALIGN float rows[kTall * kWidth];
    lightDistances(in, x0, y0, to, distances);
    for (std::size_t y = 0; y < kTall; ++y)
        for (std::size_t x = 0; x < kWidth; x += hn::Lanes(f)) {
            const float* d = distances + y * kWide + x;
            auto sum = hn::LoadU(f, d);
            for (std::size_t k = 1; k < kPatchSide; ++k) sum = sum + hn::LoadU(f, d + k);
            hn::StoreU(sum, f, rows + y * kWidth + x);
        }
    const auto zero = hn::Zero(f);
    const auto one = hn::Set(f, 1.0f);
    const auto share = hn::Set(f, 1.0f / static_cast<float>(kPatchSide * kPatchSide));
    const auto end = hn::Set(f, -1.0f / Denoising::kEnd);
    for (std::size_t y = 0; y < kHeight; ++y)
        for (std::size_t x = 0; x < kWidth; x += hn::Lanes(f)) {
            auto light = hn::LoadU(f, rows + y * kWidth + x);
            for (std::size_t k = 1; k < kPatchSide; ++k) light = light + hn::LoadU(f, rows + (y + k) * kWidth + x);
            auto distance = hn::Max(light * share, zero);
            const int column = x0 + static_cast<int>(x);
            const int row = y0 + static_cast<int>(y);
            for (int k = 0; k < DenoisePlanes::kCloseness; ++k) {
                const auto d = hn::LoadU(f, in.at(DenoisePlanes::closeness + k, column, row)) -
                               hn::LoadU(f, in.at(DenoisePlanes::closeness + k, column + to.dx, row + to.dy));
                distance = hn::MulAdd(d, d, distance);
            }
            auto w = hn::Max(hn::MulAdd(distance, end, one), zero);
            w = w * w;
            w = w * w;
            hn::StoreU(w * w, f, weights + y * kWidth + x);
        }
}

/// Adds w * t_i * t_j and w * t_i of all neighbours: the lower triangle, row by row.
HWY_INLINE void sumMatrix(const DenoisePlanes& in, int x, int y, const float* weights, V* matrix) {
    const F f;
    constexpr float kFar = Denoising::kRadius;
    constexpr std::size_t kEntries = kUnknowns * (kUnknowns + 1) / 2;
    for (std::size_t n = 0; n < kEntries; ++n) matrix[n] = hn::Zero(f);
    V own[DenoisePlanes::kTerms];
    for (int k = 0; k < DenoisePlanes::kTerms; ++k) own[k] = hn::LoadU(f, in.at(DenoisePlanes::terms + k, x, y));
    for (const Neighbor& to : neighbors()) {
        const auto w = hn::LoadU(f, weights);
        weights += kArea;
        V t[kSlopes];
        t[0] = hn::Set(f, static_cast<float>(to.dx) / kFar);
        t[1] = hn::Set(f, static_cast<float>(to.dy) / kFar);
        for (int k = 0; k < DenoisePlanes::kTerms; ++k)
            t[2 + k] = hn::LoadU(f, in.at(DenoisePlanes::terms + k, x + to.dx, y + to.dy)) - own[k];
        std::size_t at = 0;
        for (std::size_t i = 0; i < kSlopes; ++i) {
            const auto wi = w * t[i];
            for (std::size_t j = 0; j <= i; ++j, ++at) matrix[at] = hn::MulAdd(wi, t[j], matrix[at]);
            matrix[kEntries - kUnknowns + i] = matrix[kEntries - kUnknowns + i] + wi;
        }
        matrix[kEntries - 1] = matrix[kEntries - 1] + w;
    }
}

/// Adds w * t_i * color of all neighbours: unknowns fastest, then channels.
template <std::size_t kChannels>
HWY_INLINE void sumRight(const DenoisePlanes& in, int x, int y, const float* weights, V* right) {
    const F f;
    constexpr float kFar = Denoising::kRadius;
    for (std::size_t n = 0; n < kChannels * kUnknowns; ++n) right[n] = hn::Zero(f);
    V own[DenoisePlanes::kTerms];
    for (int k = 0; k < DenoisePlanes::kTerms; ++k) own[k] = hn::LoadU(f, in.at(DenoisePlanes::terms + k, x, y));
    for (const Neighbor& to : neighbors()) {
        const auto w = hn::LoadU(f, weights);
        weights += kArea;
        V t[kSlopes];
        t[0] = hn::Set(f, static_cast<float>(to.dx) / kFar);
        t[1] = hn::Set(f, static_cast<float>(to.dy) / kFar);
        for (int k = 0; k < DenoisePlanes::kTerms; ++k)
            t[2 + k] = hn::LoadU(f, in.at(DenoisePlanes::terms + k, x + to.dx, y + to.dy)) - own[k];
        for (std::size_t c = 0; c < kChannels; ++c) {
            const auto wc = w * hn::LoadU(f, in.at(DenoisePlanes::color + static_cast<int>(c), x + to.dx, y + to.dy));
            V* sums = right + c * kUnknowns;
            for (std::size_t i = 0; i < kSlopes; ++i) sums[i] = hn::MulAdd(wc, t[i], sums[i]);
            sums[kSlopes] = sums[kSlopes] + wc;
        }
    }
}

/// The constants of the fits, by Cholesky's factorization of the ridged matrix.
template <std::size_t kChannels>
HWY_INLINE void solve(const V* matrix, const V* right, V* values) {
    const F f;
    V l[kUnknowns * (kUnknowns + 1) / 2];
    V inverse[kUnknowns];  // of the diagonal
    const V total = matrix[kUnknowns * (kUnknowns + 1) / 2 - 1];
    const V ridge = total * hn::Set(f, Denoising::kRidge);
    const V least = total * hn::Set(f, 1e-6f);
    for (std::size_t i = 0; i < kUnknowns; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            const std::size_t at = i * (i + 1) / 2 + j;
            V sum = matrix[at];
            if (i == j && i != kSlopes) sum = sum + ridge;
            for (std::size_t k = 0; k < j; ++k)
                sum = hn::NegMulAdd(l[i * (i + 1) / 2 + k], l[j * (j + 1) / 2 + k], sum);
            if (i == j) {
                l[at] = hn::Sqrt(hn::Max(sum, least));
                inverse[i] = hn::Set(f, 1.0f) / l[at];
            } else {
                l[at] = sum * inverse[j];
            }
        }
    for (std::size_t c = 0; c < kChannels; ++c) {
        V y[kUnknowns];
        for (std::size_t i = 0; i < kUnknowns; ++i) {
            V rest = right[c * kUnknowns + i];
            for (std::size_t k = 0; k < i; ++k) rest = hn::NegMulAdd(l[i * (i + 1) / 2 + k], y[k], rest);
            y[i] = rest * inverse[i];
        }
        values[c] = hn::Max(y[kSlopes] * inverse[kSlopes], hn::Zero(f));
    }
}

/// A linear function may leave the range of what is around: one very bright neighbour among few of a kind turns it, and
/// it falls far below all of them at the pixel itself. Values are no less than the least of the 3 x 3 pixels, below
/// which a mean of theirs is not. Not so from above: of sparse light most pixels, and all of these, may have less than
/// the mean.
template <std::size_t kChannels>
HWY_INLINE void keepAboveLeast(const DenoisePlanes& in, int x, int y, V* values) {
    const F f;
    for (std::size_t c = 0; c < kChannels; ++c) {
        const int plane = DenoisePlanes::color + static_cast<int>(c);
        V least = hn::LoadU(f, in.at(plane, x, y));
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) least = hn::Min(least, hn::LoadU(f, in.at(plane, x + dx, y + dy)));
        values[c] = hn::Max(values[c], least);
    }
}

template <std::size_t kChannels>
HWY_INLINE void fit(const DenoisePlanes& in, int x0, int y0, DenoiseScratch& scratch) {
    const F f;
    const std::vector<Neighbor>& around = neighbors();
    for (std::size_t n = 0; n < around.size(); ++n) weigh(in, x0, y0, around[n], scratch.weights.data() + n * kArea);
    V matrix[kUnknowns * (kUnknowns + 1) / 2];
    V right[kChannels * kUnknowns];
    V values[kChannels];
    for (std::size_t y = 0; y < kHeight; ++y)
        for (std::size_t x = 0; x < kWidth; x += hn::Lanes(f)) {
            const float* weights = scratch.weights.data() + y * kWidth + x;
            sumMatrix(in, x0 + static_cast<int>(x), y0 + static_cast<int>(y), weights, matrix);
            sumRight<kChannels>(in, x0 + static_cast<int>(x), y0 + static_cast<int>(y), weights, right);
            solve<kChannels>(matrix, right, values);
            keepAboveLeast<kChannels>(in, x0 + static_cast<int>(x), y0 + static_cast<int>(y), values);
            for (std::size_t c = 0; c < kChannels; ++c) hn::StoreU(values[c], f, &scratch.colors[c][y * kWidth + x]);
        }
}

void Denoise(const DenoisePlanes& in, int x0, int y0, DenoiseScratch& scratch) {
    if (in.channels() == 3)
        fit<3>(in, x0, y0, scratch);
    else
        fit<4>(in, x0, y0, scratch);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace stratum::shade
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stratum::shade {
namespace {
HWY_EXPORT(Denoise);

int roundedUp(int n, int to) { return (n + to - 1) / to * to; }
}  // namespace

DenoisePlanes::DenoisePlanes(int width, int height, bool with_alpha)
    : width_(width),
      height_(height),
      end_x_(roundedUp(width, kBlockWidth) + 2 * kMargin),
      end_y_(roundedUp(height, kBlockHeight) + kMargin),
      stride_(static_cast<std::size_t>(end_x_ + kMargin)) {
    static_assert(Denoising::kRadius + Denoising::kPatch <= kMargin);
    for (int plane = 0; plane < (with_alpha ? kPlanes : alpha); ++plane)
        values_[static_cast<std::size_t>(plane)].resize(stride_ * static_cast<std::size_t>(end_y_ + kMargin));
}

void denoiseBlock(const DenoisePlanes& planes, int x0, int y0, DenoiseScratch& scratch) {
    scratch.weights.resize(neighbors().size() * kArea);
    for (std::vector<float>& color : scratch.colors) color.resize(kArea);
    HWY_DYNAMIC_DISPATCH(Denoise)(planes, x0, y0, scratch);
}

}  // namespace stratum::shade
#endif  // HWY_ONCE
