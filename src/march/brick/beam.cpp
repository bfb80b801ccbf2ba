#include "march/brick/beam.h"

#include <cmath>

namespace stratum::march {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kFewRays = 64;  // for fewer rays beams cost more than they save
constexpr double kSteepest = 8;       // slope against the main axis; rays that differ more have no axis in common

}  // namespace

std::span<const double> Beams::starts(std::span<const trace::Ray> rays) {
    const std::size_t count = rays.size();
    if (count < kFewRays || count > kMostRays) return {};
    const trace::Ray& first = rays[0];
    if (rays[1].origin != first.origin || rays[count / 2].origin != first.origin ||
        rays[count - 1].origin != first.origin)
        return {};
    eye_ = map_.to_cells * first.origin + map_.origin;
    const glm::dvec3 ahead = map_.to_cells * rays[count / 2].direction;
    main_ = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (std::abs(ahead[axis]) > std::abs(ahead[main_])) main_ = axis;
    forth_ = ahead[main_] > 0;
    const int axes[2] = {(main_ + 1) % 3, (main_ + 2) % 3};
    const glm::dmat3 rows = glm::transpose(map_.to_cells);
    const glm::dvec3 row_main = rows[main_];
    const glm::dvec3 row_u = rows[axes[0]];
    const glm::dvec3 row_v = rows[axes[1]];

    Bounds all;
    bool common = true;
    for (std::size_t n = 0; n < count; ++n) {
        const trace::Ray& ray = rays[n];
        const double inverse = 1 / glm::dot(row_main, ray.direction);
        const double u = glm::dot(row_u, ray.direction) * inverse;
        const double v = glm::dot(row_v, ray.direction) * inverse;
        // Written so that rays with NaN fail the test.
        common &= ray.origin == first.origin && (inverse > 0) == forth_ && std::abs(u) < kSteepest &&
                  std::abs(v) < kSteepest && std::abs(inverse) < kInfinity;
        slope_[0][n] = u;
        slope_[1][n] = v;
        slope_[2][n] = inverse;
        all.low[0] = std::min(all.low[0], u);
        all.high[0] = std::max(all.high[0], u);
        all.low[1] = std::min(all.low[1], v);
        all.high[1] = std::max(all.high[1], v);
    }
    if (!common || !std::isfinite(eye_.x + eye_.y + eye_.z)) return {};

    std::array<Bounds, std::size_t{kSide} * kSide> beams;
    double scale[2];
    for (std::size_t k = 0; k < 2; ++k) {
        const double width = all.high[k] - all.low[k];
        scale[k] = width > 0 ? kSide * (1 - 1e-9) / width : 0;
    }
    for (std::size_t n = 0; n < count; ++n) {
        const double u = slope_[0][n];
        const double v = slope_[1][n];
        const int beam =
            static_cast<int>((u - all.low[0]) * scale[0]) * kSide + static_cast<int>((v - all.low[1]) * scale[1]);
        beam_[n] = static_cast<std::uint8_t>(beam);
        Bounds& b = beams[static_cast<std::size_t>(beam)];
        b.low[0] = std::min(b.low[0], u);
        b.high[0] = std::max(b.high[0], u);
        b.low[1] = std::min(b.low[1], v);
        b.high[1] = std::max(b.high[1], v);
    }
    std::array<double, std::size_t{kSide} * kSide> way;  // along the main axis
    for (std::size_t n = 0; n < beams.size(); ++n)
        way[n] = beams[n].low[0] <= beams[n].high[0] ? firstPlane(beams[n]) - eye_[main_] : 0;
    for (std::size_t n = 0; n < count; ++n) start_[n] = way[beam_[n]] * slope_[2][n];
    return {start_.data(), count};
}

// The plane across the main axis that a beam reaches before any brick, one cell earlier; infinitely far ahead if there
// is none.
double Beams::firstPlane(const Bounds& slopes) const {
    const std::array<int, 3>& size = grid_.size();
    const int axes[3] = {main_, (main_ + 1) % 3, (main_ + 2) % 3};
    const auto sizeOf = [&](int axis) { return size[static_cast<std::size_t>(axis)]; };
    // The box of cells that the beam has in [from, to] of the main axis, widened by one cell against rounding; false if
    // it has none in the grid.
    int low[3];
    int high[3];  // inclusive
    const auto cover = [&](int from, int to) {
        low[main_] = from;
        high[main_] = to - 1;
        const double near = std::min(std::abs(from - eye_[main_]), std::abs(to - eye_[main_]));
        const double far = std::max(std::abs(from - eye_[main_]), std::abs(to - eye_[main_]));
        for (std::size_t k = 0; k < 2; ++k) {
            const int axis = axes[k + 1];
            const double sign = forth_ ? 1 : -1;  // slopes are against the axis, not along the way
            const double a = std::min(sign * slopes.low[k], sign * slopes.high[k]);
            const double b = std::max(sign * slopes.low[k], sign * slopes.high[k]);
            const double least = eye_[axis] + std::min(a * near, a * far) - 1;
            const double most = eye_[axis] + std::max(b * near, b * far) + 1;
            if (!(most >= 0 && least < sizeOf(axis))) return false;
            low[axis] = static_cast<int>(std::max(least, 0.0));
            high[axis] = static_cast<int>(std::min(most, sizeOf(axis) - 1.0));
        }
        return true;
    };
    constexpr int kSlab = BrickGrid::kMacroEdge;
    constexpr int kThin = BrickGrid::kBrickEdge;
    const int slabs = sizeOf(main_) / kSlab;
    // Slabs behind the eye are skipped; the eye's own slab counts as a whole.
    const double at = eye_[main_] / kSlab;
    const int begin = forth_ ? static_cast<int>(std::clamp(at, 0.0, slabs - 1.0))
                             : static_cast<int>(std::clamp(std::ceil(at), 1.0, static_cast<double>(slabs))) - 1;
    for (int n = begin; forth_ ? n < slabs : n >= 0; n += forth_ ? 1 : -1) {
        const bool eye_within = eye_[main_] > n * kSlab && eye_[main_] < (n + 1) * kSlab;
        if (eye_within) return eye_[main_];
        if (!cover(n * kSlab, (n + 1) * kSlab)) continue;
        bool any = false;
        for (int x = low[0] / kSlab; x <= high[0] / kSlab && !any; ++x)
            for (int y = low[1] / kSlab; y <= high[1] / kSlab && !any; ++y)
                for (int z = low[2] / kSlab; z <= high[2] / kSlab && !any; ++z)
                    any = grid_.macroCell(x, y, z).bricks != 0;
        if (!any) continue;
        for (int thin = 0; thin < kSlab; thin += kThin) {
            const int from = n * kSlab + (forth_ ? thin : kSlab - kThin - thin);
            if (cover(from, from + kThin) && occupied(low, high)) return forth_ ? from - 1 : from + kThin + 1;
        }
    }
    return forth_ ? kInfinity : -kInfinity;
}

// Whether there is a brick among these cells.
bool Beams::occupied(const int (&low)[3], const int (&high)[3]) const {
    for (int x = low[0] >> 3; x <= high[0] >> 3; ++x)
        for (int y = low[1] >> 3; y <= high[1] >> 3; ++y)
            for (int z = low[2] >> 3; z <= high[2] >> 3; ++z)
                if ((grid_.macroCell(x >> 2, y >> 2, z >> 2).bricks >> Mask64::bit(x & 3, y & 3, z & 3) & 1) != 0)
                    return true;
    return false;
}

}  // namespace stratum::march
