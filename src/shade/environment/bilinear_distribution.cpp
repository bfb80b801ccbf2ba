#include "shade/environment/bilinear_distribution.h"

#include "shade/environment/normal_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr int kBlocksAcross = 32;

/// The interval of a running sum that contains u times its last value, never an empty one, and the offset in it.
struct Place {
    std::size_t index;
    double offset;  // [0, 1)
};

/// @param sums  without the leading 0; the last is above 0
template <typename T>
Place find(const T* sums, std::size_t count, double u) {
    const double target = u * static_cast<double>(sums[count - 1]);
    // The first sum above the target: a branchless search, because branches would be mispredicted half of the time.
    const T* first = sums;
    for (std::size_t left = count; left > 1;) {
        const std::size_t half = left / 2;
        first += static_cast<double>(first[half - 1]) <= target ? half : 0;
        left -= half;
    }
    const double below = first == sums ? 0.0 : static_cast<double>(first[-1]);
    const double width = static_cast<double>(*first) - below;
    return {static_cast<std::size_t>(first - sums), std::clamp((target - below) / width, 0.0, kBelowOne)};
}

/// The quantile u of a density that is linear from a to b over [0, 1).
double drawLinear(double a, double b, double u) {
    if (!(a + b > 0.0)) return u;
    // The root without cancellation, for falling and rising densities alike.
    const double x = u * (a + b) / (a + std::sqrt((1.0 - u) * a * a + u * b * b));
    return std::clamp(x, 0.0, kBelowOne);
}

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
                if (row <= rows_ && column < columns_) sum += corners(column, row).at(0.5, 0.5);
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

BilinearDistribution::Corners BilinearDistribution::corners(int column, int row) const {
    const int right = column + 1 == columns_ ? 0 : column + 1;
    const auto above = static_cast<std::size_t>(std::max(row - 1, 0)) * static_cast<std::size_t>(columns_);
    const auto below = static_cast<std::size_t>(std::min(row, rows_ - 1)) * static_cast<std::size_t>(columns_);
    const auto left_column = static_cast<std::size_t>(column);
    const auto right_column = static_cast<std::size_t>(right);
    return {static_cast<double>(weights_[above + left_column]), static_cast<double>(weights_[above + right_column]),
            static_cast<double>(weights_[below + left_column]), static_cast<double>(weights_[below + right_column])};
}

int BilinearDistribution::bin(const glm::vec3& normal) const { return bins_ == 1 ? 0 : NormalBins::of(normal); }

double BilinearDistribution::scale(int bin, int column, int row) const {
    const std::size_t block = blockOf(column, row);
    const std::size_t block_row = static_cast<std::size_t>(bin) * block_rows_ + static_cast<std::size_t>(row >> shift_);
    const float row_scale = row_scales_[block_row];
    if (!(row_scale > 0.0f)) return 0.0;
    const std::size_t c = static_cast<std::size_t>(column >> shift_);
    const float* sums = &block_sums_[block_row * block_columns_];
    const float share = c > 0 ? sums[c] - sums[c - 1] : sums[0];
    if (!(share > 0.0f)) return 0.0;
    return static_cast<double>(row_scale) * static_cast<double>(share) / block_weights_[block] *
           sines_[static_cast<std::size_t>(row)] * columns_ * rows_;
}

glm::dvec2 BilinearDistribution::sample(int bin, const glm::dvec2& u, double& pdf) const {
    pdf = 0.0;
    const std::size_t first_row = static_cast<std::size_t>(bin) * block_rows_;
    if (!(row_sums_[first_row + block_rows_ - 1] > 0.0)) return {0.0, 0.0};
    const Place block_row = find(&row_sums_[first_row], block_rows_, u.y);
    const Place block_column = find(&block_sums_[(first_row + block_row.index) * block_columns_], block_columns_, u.x);
    const std::size_t block = block_row.index * block_columns_ + block_column.index;
    const Place row_inside = find(&rows_in_block_[block * side()], side(), block_row.offset);
    const Place inside =
        find(&cells_in_block_[(block * side() + row_inside.index) * side()], side(), block_column.offset);
    const int row = static_cast<int>((block_row.index << shift_) + row_inside.index);
    const int column = static_cast<int>((block_column.index << shift_) + inside.index);
    const Corners c = corners(column, row);
    const double y = drawLinear(c.w00 + c.w10, c.w01 + c.w11, row_inside.offset);
    const double x = drawLinear((1.0 - y) * c.w00 + y * c.w01, (1.0 - y) * c.w10 + y * c.w11, inside.offset);
    const glm::dvec2 point((column + x + 0.5) / columns_, (row + y - 0.5) / rows_);
    if (!(point.y > 0.0 && point.y < 1.0)) return point;  // half of the outermost rows lies beyond the poles
    pdf = c.at(x, y) * scale(bin, column, row);
    return {point.x < 1.0 ? point.x : point.x - 1.0, point.y};
}

double BilinearDistribution::pdf(int bin, const glm::dvec2& point) const {
    double sx = point.x * columns_ - 0.5;
    if (sx < 0.0) sx += columns_;
    const double sy = point.y * rows_ + 0.5;
    const int column = std::clamp(static_cast<int>(sx), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(sy), 0, rows_);
    const double density = scale(bin, column, row);
    if (!(density > 0.0)) return 0.0;
    const double x = std::clamp(sx - column, 0.0, 1.0);
    const double y = std::clamp(sy - row, 0.0, 1.0);
    return corners(column, row).at(x, y) * density;
}

}  // namespace stratum::shade
