#include "shade/distribution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace stratum::shade {
namespace {

constexpr double kPiD = std::numbers::pi;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// The cell of a running sum from 0 to 1 in which `u` falls, never an empty one, and how far into it.
struct Place {
    int cell;
    double offset;  // [0, 1)
};
Place find(const double* cdf, int cells, double u) {
    const double* end = cdf + cells + 1;
    // The first entry above u: the cell before it has a positive width.
    const double* above = std::upper_bound(cdf, end, u);
    if (above == end) above = std::lower_bound(cdf, end, 1.0);  // u is 1 but for rounding: the last cell of any width
    const int cell = std::max(0, static_cast<int>(above - cdf) - 1);
    const double width = cdf[cell + 1] - cdf[cell];
    return {cell, std::clamp((u - cdf[cell]) / width, 0.0, 0x1.fffffffffffffp-1)};
}

std::vector<double> tabulate(const std::function<double(const glm::dvec3&)>& weight, int columns, int rows) {
    constexpr int kCuts = 3;
    std::vector<double> table(at(columns) * at(rows));
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            double sum = 0.0;
            for (int a = 0; a < kCuts; ++a) {
                const double theta = kPiD * (row + (a + 0.5) / kCuts) / rows;
                for (int b = 0; b < kCuts; ++b) {
                    const double phi = 2.0 * kPiD * (column + (b + 0.5) / kCuts) / columns;
                    sum += std::sin(theta) *
                           weight({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
                }
            }
            table[at(row) * at(columns) + at(column)] = sum;
        }
    }
    return table;
}

}  // namespace

Distribution2D::Distribution2D(const std::vector<double>& weights, int columns, int rows)
    : columns_(columns),
      rows_(rows),
      column_cdf_(at(rows) * at(columns + 1)),
      row_cdf_(at(rows + 1)),
      density_(weights) {
    double total = 0.0;
    for (const double w : weights) total += w;
    if (!(total > 0.0)) {
        std::fill(density_.begin(), density_.end(), 1.0);
        total = static_cast<double>(density_.size());
    }
    double above = 0.0;
    for (int row = 0; row < rows_; ++row) {
        double* cdf = &column_cdf_[at(row) * at(columns_ + 1)];
        const double* w = &density_[at(row) * at(columns_)];
        double sum = 0.0;
        for (int i = 0; i < columns_; ++i) {
            cdf[i] = sum;
            sum += w[i];
        }
        // A row without weight is never chosen; any valid numbers will do.
        for (int i = 0; i < columns_; ++i) cdf[i] = sum > 0.0 ? cdf[i] / sum : static_cast<double>(i) / columns_;
        cdf[columns_] = 1.0;
        row_cdf_[at(row)] = above / total;
        above += sum;
    }
    row_cdf_[at(rows_)] = 1.0;
    // The density that the running sums really give, rounding and all.
    for (int row = 0; row < rows_; ++row) {
        const double* cdf = &column_cdf_[at(row) * at(columns_ + 1)];
        const double height = (row_cdf_[at(row + 1)] - row_cdf_[at(row)]) * rows_;
        for (int i = 0; i < columns_; ++i)
            density_[at(row) * at(columns_) + at(i)] = height * (cdf[i + 1] - cdf[i]) * columns_;
    }
}

glm::dvec2 Distribution2D::sample(const glm::dvec2& u, double& pdf) const {
    const Place row = find(row_cdf_.data(), rows_, u.y);
    const Place column = find(&column_cdf_[at(row.cell) * at(columns_ + 1)], columns_, u.x);
    pdf = density_[at(row.cell) * at(columns_) + at(column.cell)];
    return {(column.cell + column.offset) / columns_, (row.cell + row.offset) / rows_};
}

double Distribution2D::pdf(const glm::dvec2& point) const {
    const int column = std::clamp(static_cast<int>(point.x * columns_), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(point.y * rows_), 0, rows_ - 1);
    return density_[at(row) * at(columns_) + at(column)];
}

SphereDistribution::SphereDistribution(const std::function<double(const glm::dvec3&)>& weight, int columns, int rows)
    : table_(tabulate(weight, columns, rows), columns, rows) {}

glm::vec3 SphereDistribution::sample(const glm::vec2& u, float& pdf) const {
    double density = 0.0;
    const glm::dvec2 place = table_.sample(u, density);
    const double theta = kPiD * place.y;
    const double phi = 2.0 * kPiD * place.x;
    const double s = std::sin(theta);
    pdf = s > 0.0 ? static_cast<float>(density / (2.0 * kPiD * kPiD * s)) : 0.0f;
    if (!std::isfinite(pdf)) pdf = 0.0f;
    return {s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
}

float SphereDistribution::pdf(const glm::vec3& direction) const {
    const double x = direction.x;
    const double y = direction.y;
    const double z = direction.z;
    const double s = std::sqrt(x * x + y * y);
    if (!(s > 0.0)) return 0.0f;
    double phi = std::atan2(y, x);
    if (phi < 0.0) phi += 2.0 * kPiD;
    const double theta = std::atan2(s, z);
    return static_cast<float>(table_.pdf({phi / (2.0 * kPiD), theta / kPiD}) / (2.0 * kPiD * kPiD * s));
}

}  // namespace stratum::shade
