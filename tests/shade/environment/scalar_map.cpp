#include "shade/environment/scalar_map.h"

#include "shade/environment/normal_bins.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::test {
namespace {

using shade::BilinearDistribution;
using shade::Color;
using shade::EnvironmentSample;
using shade::kBelowOne;
using shade::LightMap;
using shade::PlacedMap;
using View = BilinearDistribution::View;

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

/// Weights at the corners of a cell between texel centers. Row 0 lies above the first row of centers.
struct Corners {
    double w00, w10, w01, w11;
    double at(double x, double y) const {
        return (1.0 - y) * ((1.0 - x) * w00 + x * w10) + y * ((1.0 - x) * w01 + x * w11);
    }
};

Corners cornersOf(const View& t, int column, int row) {
    const int right = column + 1 == t.columns ? 0 : column + 1;
    const auto above = static_cast<std::size_t>(std::max(row - 1, 0)) * static_cast<std::size_t>(t.columns);
    const auto below = static_cast<std::size_t>(std::min(row, t.rows - 1)) * static_cast<std::size_t>(t.columns);
    const auto left_column = static_cast<std::size_t>(column);
    const auto right_column = static_cast<std::size_t>(right);
    return {static_cast<double>(t.weights[above + left_column]), static_cast<double>(t.weights[above + right_column]),
            static_cast<double>(t.weights[below + left_column]), static_cast<double>(t.weights[below + right_column])};
}

/// Density over interpolated weight, in a cell.
double scaleOf(const View& t, int bin, int column, int row) {
    const std::size_t block =
        static_cast<std::size_t>(row >> t.shift) * t.block_columns + static_cast<std::size_t>(column >> t.shift);
    const std::size_t block_row =
        static_cast<std::size_t>(bin) * t.block_rows + static_cast<std::size_t>(row >> t.shift);
    const float row_scale = t.row_scales[block_row];
    if (!(row_scale > 0.0f)) return 0.0;
    const std::size_t c = static_cast<std::size_t>(column >> t.shift);
    const float* sums = &t.block_sums[block_row * t.block_columns];
    const float share = c > 0 ? sums[c] - sums[c - 1] : sums[0];
    if (!(share > 0.0f)) return 0.0;
    return static_cast<double>(row_scale) * static_cast<double>(share) / t.block_weights[block] *
           t.sines[static_cast<std::size_t>(row)] * t.columns * t.rows;
}

glm::dvec2 positionOf(const glm::vec3& direction, double rotation, double& sine) {
    const double x = direction.x;
    const double y = direction.y;
    sine = std::sqrt(x * x + y * y);
    double u = 0.5 - (std::atan2(y, x) - rotation) / (2.0 * std::numbers::pi);
    u -= std::floor(u);
    const double v = std::atan2(sine, static_cast<double>(direction.z)) / std::numbers::pi;
    return {u < 1.0 ? u : 0.0, v};
}

Color lookUp(const LightMap& map, const glm::dvec2& uv) {
    double sx = uv.x * map.width - 0.5;
    if (sx < 0.0) sx += map.width;
    const double sy = std::clamp(uv.y * map.height - 0.5, 0.0, map.height - 1.0);
    const int x0 = std::clamp(static_cast<int>(sx), 0, map.width - 1);
    const int y0 = std::min(static_cast<int>(sy), map.height - 1);
    const int x1 = x0 + 1 == map.width ? 0 : x0 + 1;
    const int y1 = std::min(y0 + 1, map.height - 1);
    const auto wx = static_cast<float>(sx - x0);
    const auto wy = static_cast<float>(sy - y0);
    return (1.0f - wy) * ((1.0f - wx) * map.at(x0, y0) + wx * map.at(x1, y0)) +
           wy * ((1.0f - wx) * map.at(x0, y1) + wx * map.at(x1, y1));
}

}  // namespace

int binOf(const BilinearDistribution& table, const glm::vec3& normal) {
    return table.view().bins == 1 ? 0 : shade::NormalBins::of(normal);
}

glm::dvec2 drawFrom(const BilinearDistribution& table, int bin, const glm::dvec2& u, double& pdf) {
    const View t = table.view();
    const std::size_t side = std::size_t{1} << t.shift;
    pdf = 0.0;
    const std::size_t first_row = static_cast<std::size_t>(bin) * t.block_rows;
    if (!(t.row_sums[first_row + t.block_rows - 1] > 0.0)) return {0.0, 0.0};
    const Place block_row = find(&t.row_sums[first_row], t.block_rows, u.y);
    const Place block_column =
        find(&t.block_sums[(first_row + block_row.index) * t.block_columns], t.block_columns, u.x);
    const std::size_t block = block_row.index * t.block_columns + block_column.index;
    const Place row_inside = find(&t.rows_in_block[block * side], side, block_row.offset);
    const Place inside = find(&t.cells_in_block[(block * side + row_inside.index) * side], side, block_column.offset);
    const int row = static_cast<int>((block_row.index << t.shift) + row_inside.index);
    const int column = static_cast<int>((block_column.index << t.shift) + inside.index);
    const Corners c = cornersOf(t, column, row);
    const double y = drawLinear(c.w00 + c.w10, c.w01 + c.w11, row_inside.offset);
    const double x = drawLinear((1.0 - y) * c.w00 + y * c.w01, (1.0 - y) * c.w10 + y * c.w11, inside.offset);
    const glm::dvec2 point((column + x + 0.5) / t.columns, (row + y - 0.5) / t.rows);
    if (!(point.y > 0.0 && point.y < 1.0)) return point;  // half of the outermost rows lies beyond the poles
    pdf = c.at(x, y) * scaleOf(t, bin, column, row);
    return {point.x < 1.0 ? point.x : point.x - 1.0, point.y};
}

double densityOf(const BilinearDistribution& table, int bin, const glm::dvec2& point) {
    const View t = table.view();
    double sx = point.x * t.columns - 0.5;
    if (sx < 0.0) sx += t.columns;
    const double sy = point.y * t.rows + 0.5;
    const int column = std::clamp(static_cast<int>(sx), 0, t.columns - 1);
    const int row = std::clamp(static_cast<int>(sy), 0, t.rows);
    const double density = scaleOf(t, bin, column, row);
    if (!(density > 0.0)) return 0.0;
    const double x = std::clamp(sx - column, 0.0, 1.0);
    const double y = std::clamp(sy - row, 0.0, 1.0);
    return cornersOf(t, column, row).at(x, y) * density;
}

glm::vec3 directionOf(const glm::dvec2& uv, double rotation, double& sine) {
    const double theta = std::numbers::pi * uv.y;
    const double phi = 2.0 * std::numbers::pi * (0.5 - uv.x) + rotation;
    sine = std::sin(theta);
    return {sine * std::cos(phi), sine * std::sin(phi), std::cos(theta)};
}

EnvironmentSample sampleOne(const PlacedMap& placed, int strategy, const glm::vec2& u, const glm::vec3& normal) {
    const auto chosen = static_cast<std::size_t>(strategy);
    double density = 0.0;
    const glm::dvec2 uv = drawFrom(placed.tables[chosen], binOf(placed.tables[chosen], normal), u, density);
    EnvironmentSample result;
    if (!(density > 0.0)) return result;
    double sine = 0.0;
    result.direction = directionOf(uv, placed.rotation, sine);
    if (!(sine > 0.0)) return result;
    for (std::size_t k = 0; k < placed.tables.size(); ++k)
        if (k != chosen) density += densityOf(placed.tables[k], binOf(placed.tables[k], normal), uv);
    result.pdf = static_cast<float>(density / (2.0 * std::numbers::pi * std::numbers::pi * sine));
    if (!std::isfinite(result.pdf)) result.pdf = 0.0f;
    result.radiance = lookUp(placed.map, uv);
    return result;
}

EnvironmentSample evalOne(const PlacedMap& placed, const glm::vec3& direction, const glm::vec3& normal) {
    double sine = 0.0;
    const glm::dvec2 uv = positionOf(direction, placed.rotation, sine);
    double density = 0.0;
    for (const BilinearDistribution& table : placed.tables) density += densityOf(table, binOf(table, normal), uv);
    const auto pdf = static_cast<float>(density / (2.0 * std::numbers::pi * std::numbers::pi * sine));
    return {direction, lookUp(placed.map, uv), sine > 0.0 && std::isfinite(pdf) ? pdf : 0.0f};
}

}  // namespace stratum::test
