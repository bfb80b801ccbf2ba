#include "shade/bilinear_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr double kBelowOne = 0x1.fffffffffffffp-1;

/// The interval of a running sum in which u * total falls, never an empty one, and how far into it.
struct Place {
    int index;
    double offset;  // [0, 1)
};
Place find(const double* sums, int count, double u) {
    const double target = u * sums[count];
    const double* above = std::upper_bound(sums, sums + count + 1, target);
    if (above == sums + count + 1) above = std::lower_bound(sums, sums + count + 1, sums[count]);
    const int index = std::max(0, static_cast<int>(above - sums) - 1);
    return {index, std::clamp((target - sums[index]) / (sums[index + 1] - sums[index]), 0.0, kBelowOne)};
}

/// Where a density that goes linearly from a to b over [0, 1) has the share u below it.
double drawLinear(double a, double b, double u) {
    if (!(a + b > 0.0)) return u;
    // The root without cancellation, for falling and rising densities alike.
    const double x = u * (a + b) / (a + std::sqrt((1.0 - u) * a * a + u * b * b));
    return std::clamp(x, 0.0, kBelowOne);
}

}  // namespace

BilinearDistribution::BilinearDistribution(std::vector<float> weights, int columns, int rows)
    : columns_(columns), rows_(rows), weights_(std::move(weights)) {
    if (std::none_of(weights_.begin(), weights_.end(), [](float w) { return w > 0.0f; }))
        std::fill(weights_.begin(), weights_.end(), 1.0f);
    const auto width = static_cast<std::size_t>(columns_) + 1;
    const auto cells = static_cast<std::size_t>(rows_) + 1;
    sums_.resize(width * cells);
    row_sums_.resize(cells + 1);
    sines_.resize(cells);
    for (int row = 0; row <= rows_; ++row) {
        const auto r = static_cast<std::size_t>(row);
        const double above = kPiD * std::max(0.0, (row - 0.5) / rows_);
        const double below = kPiD * std::min(1.0, (row + 0.5) / rows_);
        sines_[r] = (std::cos(above) - std::cos(below)) / (below - above);
        double* sums = &sums_[r * width];
        for (int i = 0; i < columns_; ++i) {
            const Corners c = corners(i, row);
            sums[i + 1] = sums[i] + 0.25 * (c.w00 + c.w10 + c.w01 + c.w11);
        }
        row_sums_[r + 1] = row_sums_[r] + sums[columns_] * sines_[r];
        if (sums[columns_] > 0.0) {
            if (first_row_ > last_row_) first_row_ = row;
            last_row_ = row;
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

glm::dvec2 BilinearDistribution::sample(const glm::dvec2& u, double& pdf) const {
    const auto width = static_cast<std::size_t>(columns_) + 1;
    const Place row = find(row_sums_.data(), rows_ + 1, u.y);
    const Place column = find(&sums_[static_cast<std::size_t>(row.index) * width], columns_, u.x);
    const Corners c = corners(column.index, row.index);
    const double y = drawLinear(c.w00 + c.w10, c.w01 + c.w11, row.offset);
    const double x = drawLinear((1.0 - y) * c.w00 + y * c.w01, (1.0 - y) * c.w10 + y * c.w11, column.offset);
    const glm::dvec2 point((column.index + x + 0.5) / columns_, (row.index + y - 0.5) / rows_);
    pdf = 0.0;
    if (!(point.y > 0.0 && point.y < 1.0)) return point;  // half of the outermost rows lies beyond the poles
    const double weight = (1.0 - y) * ((1.0 - x) * c.w00 + x * c.w10) + y * ((1.0 - x) * c.w01 + x * c.w11);
    pdf = weight * sines_[static_cast<std::size_t>(row.index)] * columns_ * rows_ / row_sums_.back();
    return {point.x < 1.0 ? point.x : point.x - 1.0, point.y};
}

double BilinearDistribution::pdf(const glm::dvec2& point) const {
    double sx = point.x * columns_ - 0.5;
    if (sx < 0.0) sx += columns_;
    const double sy = point.y * rows_ + 0.5;
    const int column = std::clamp(static_cast<int>(sx), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(sy), 0, rows_);
    if (row < first_row_ || row > last_row_) return 0.0;
    const double x = std::clamp(sx - column, 0.0, 1.0);
    const double y = std::clamp(sy - row, 0.0, 1.0);
    const Corners c = corners(column, row);
    const double weight = (1.0 - y) * ((1.0 - x) * c.w00 + x * c.w10) + y * ((1.0 - x) * c.w01 + x * c.w11);
    return weight * sines_[static_cast<std::size_t>(row)] * columns_ * rows_ / row_sums_.back();
}

}  // namespace stratum::shade
