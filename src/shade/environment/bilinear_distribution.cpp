#include "shade/environment/bilinear_distribution.h"

#include "shade/environment/normal_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr int kBlocksAcross = 32;

/// Scales running sums so that they end at 1, unless all are 0.
void normalize(const double* sums, std::size_t count, float* result) {
    const double total = sums[count - 1];
    for (std::size_t n = 0; n < count; ++n) result[n] = total > 0.0 ? static_cast<float>(sums[n] / total) : 0.0f;
}

}  // namespace

BilinearDistribution::BilinearDistribution(std::vector<float> weights, int columns, int rows,
                                           const Direction& direction)
    : columns_(columns), rows_(rows), weights_(std::move(weights)) {
    if (std::none_of(weights_.begin(), weights_.end(), [](float w) { return w > 0.0f; }))
        std::fill(weights_.begin(), weights_.end(), 1.0f);
    while ((columns_ - 1) >> shift_ >= kBlocksAcross) ++shift_;
    block_columns_ = static_cast<std::size_t>((columns_ - 1) >> shift_) + 1;
    block_rows_ = static_cast<std::size_t>(rows_ >> shift_) + 1;
    sumCells();
    weighBlocks(direction);
}

/// Sums of the rows and cells in each block.
void BilinearDistribution::sumCells() {
    for (int row = 0; row <= rows_; ++row) {
        const double above = std::numbers::pi * std::max(0.0, (row - 0.5) / rows_);
        const double below = std::numbers::pi * std::min(1.0, (row + 0.5) / rows_);
        sines_.push_back((std::cos(above) - std::cos(below)) / (below - above));
    }
    const std::size_t blocks = block_columns_ * block_rows_;
    rows_in_block_.resize(blocks * side() + View::kPadding);
    cells_in_block_.resize(blocks * side() * side() + View::kPadding);
    block_weights_.resize(blocks);
    std::vector<double> cells(side());
    std::vector<double> rows(side());
    for (std::size_t block = 0; block < blocks; ++block) {
        const int row0 = static_cast<int>(block / block_columns_) << shift_;
        const int column0 = static_cast<int>(block % block_columns_) << shift_;
        double block_sum = 0.0;
        for (std::size_t r = 0; r < side(); ++r) {
            const int row = row0 + static_cast<int>(r);
            double sum = 0.0;
            for (std::size_t i = 0; i < side(); ++i) {
                const int column = column0 + static_cast<int>(i);
                if (row <= rows_ && column < columns_) sum += middleOf(column, row);
                cells[i] = sum;
            }
            normalize(cells.data(), side(), &cells_in_block_[(block * side() + r) * side()]);
            if (row <= rows_) block_sum += sum * sines_[static_cast<std::size_t>(row)];
            rows[r] = block_sum;
        }
        normalize(rows.data(), side(), &rows_in_block_[block * side()]);
        block_weights_[block] = block_sum;
    }
}

/// The weight of each block, for each bin.
void BilinearDistribution::weighBlocks(const Direction& direction) {
    constexpr std::array<glm::vec2, 5> kInBin = {
        {{0.5f, 0.5f}, {0.0f, 0.0f}, {1.0f, 0.0f}, {0.0f, 1.0f}, {1.0f, 1.0f}}};
    constexpr std::size_t kProbes = 3;  // of a block, each way; the outer ones on its edges
    // A least weight for blocks that may be above the horizon of some normal between the probes.
    constexpr float kBelowHorizon = 0.03f;
    std::vector<glm::vec3> probes;
    if (direction) {
        bins_ = NormalBins::kCount;
        for (std::size_t block = 0; block < block_weights_.size(); ++block) {
            const std::size_t block_row = block / block_columns_;
            for (std::size_t p = 0; p < kProbes * kProbes; ++p) {
                const std::size_t probe_row = p / kProbes;
                const double across = static_cast<double>(p % kProbes) / (kProbes - 1.0);
                const double down = static_cast<double>(probe_row) / (kProbes - 1.0);
                const double column = (static_cast<double>(block % block_columns_) + across) * double(side());
                const double row = (static_cast<double>(block_row) + down) * double(side());
                probes.push_back(direction({(column + 0.5) / columns_, std::clamp((row - 0.5) / rows_, 0.0, 1.0)}));
            }
        }
    }
    row_sums_.resize(bins_ * block_rows_ + View::kPadding);
    row_scales_.resize(bins_ * block_rows_);
    block_sums_.resize(bins_ * block_rows_ * block_columns_ + View::kPadding);
    std::vector<double> sums(block_columns_);
    std::vector<double> row_sums(block_rows_);
    for (std::size_t bin = 0; bin < bins_; ++bin) {
        const auto share = [&](std::size_t block) {
            if (probes.empty() || !(block_weights_[block] > 0.0)) return block_weights_[block];
            float sum = 0.0f;
            for (const glm::vec2& place : kInBin) {
                const glm::vec3 normal = NormalBins::normal(static_cast<int>(bin), place);
                for (std::size_t p = 0; p < kProbes * kProbes; ++p)
                    sum += std::max(0.0f, kBelowHorizon + glm::dot(normal, probes[block * kProbes * kProbes + p]));
            }
            return block_weights_[block] * static_cast<double>(sum);
        };
        double total = 0.0;
        for (std::size_t r = 0; r < block_rows_; ++r) {
            double sum = 0.0;
            for (std::size_t c = 0; c < block_columns_; ++c) sums[c] = sum += share(r * block_columns_ + c);
            normalize(sums.data(), block_columns_, &block_sums_[(bin * block_rows_ + r) * block_columns_]);
            row_sums[r] = total += sum;
        }
        for (std::size_t r = 0; r < block_rows_; ++r) {
            const std::size_t n = bin * block_rows_ + r;
            row_sums_[n] = total > 0.0 ? row_sums[r] / total : 0.0;
            row_scales_[n] = static_cast<float>(row_sums_[n] - (r > 0 ? row_sums_[n - 1] : 0.0));
        }
    }
}

double BilinearDistribution::middleOf(int column, int row) const {
    const auto left = static_cast<std::size_t>(column);
    const std::size_t right = column + 1 == columns_ ? 0 : left + 1;
    const auto at = [&](int texel_row, std::size_t texel_column) {
        return static_cast<double>(
            weights_[static_cast<std::size_t>(texel_row) * static_cast<std::size_t>(columns_) + texel_column]);
    };
    const int above = std::max(row - 1, 0);
    const int below = std::min(row, rows_ - 1);
    return 0.25 * ((at(above, left) + at(above, right)) + (at(below, left) + at(below, right)));
}

}  // namespace stratum::shade
