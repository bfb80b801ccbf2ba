#include "voxelize/beads/bead_field.h"

#include "base/parallel_for.h"

#include <limits>
#include <mutex>
#include <numbers>

namespace stratum::voxelize {

double flatInset(double height, double radius) {
    constexpr double kCorners = 4 - std::numbers::pi;  // what four corners of radius 1 take from a rectangle
    // As written, a stadium would get rounding errors.
    if (radius >= 0.5 * height) return radius;
    return 0.5 * height * (0.25 * kCorners) - 0.5 * kCorners * radius * radius / height + radius;
}

Section sectionOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    // Widths and heights are floats that print decimals (0.2f is 0.200000003): rounding to a nanometre gives layers
    // that agree on their planes, so that the lattice can meet them exactly.
    const auto nanometres = [](double mm) { return std::round(mm * 1e6) * 1e-6; };
    const double height = nanometres(toolpath.runOf(bead).height);
    const double width = static_cast<double>(bead.width);
    Section section;
    section.drop = 0.5 * height;
    if (width < height) {
        section.radius = 0.5 * width;
    } else {
        section.radius = toolpath.deposit.cornerRadius(height);
        section.half_side = 0.5 * height - section.radius;
        section.half_flat =
            section.half_side > 0 ? 0.5 * width - flatInset(height, section.radius) : 0.5 * (width - height);
    }
    return section;
}

EndFlats endFlats(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double mean) {
    // The flat changes as the width does; half of it to each side of the mean.
    const double half_change = 0.25 * gcode::widening(toolpath, bead);
    if (half_change == 0 || bead.arc >= 0 || bead.z0 != bead.z1) return {mean, mean};
    return {std::max(mean - half_change, 0.0), std::max(mean + half_change, 0.0)};
}

BeadField::BeadField(const gcode::Toolpath& toolpath, const gcode::Bead& bead)
    : path_(toolpath, bead), x0_(bead.x0), y0_(bead.y0), dx_(bead.x1 - bead.x0), dy_(bead.y1 - bead.y0) {
    const Section section = sectionOf(toolpath, bead);
    half_flat_ = section.half_flat;
    flats_ = endFlats(toolpath, bead, half_flat_);
    radius_ = section.radius;
    half_side_ = section.half_side;
    zc0_ = bead.z0 - section.drop;
    zc1_ = bead.z1 - section.drop;
    const double climb = bead.z1 - bead.z0;
    level_ = climb == 0;
    const double plan_length = path_.length();
    if (!level_) {
        cosine_ = plan_length / std::hypot(plan_length, climb);
        if (half_flat_ > 0 && std::abs(climb) > plan_length) {
            const double area = gcode::sectionArea(bead.width, toolpath.runOf(bead).height);
            radius_ = std::sqrt(area / std::numbers::pi);
            half_flat_ = half_side_ = 0;
            flats_ = {};
        }
        if (half_flat_ > 0) reach_ = kSlopedReach * 2 * (radius_ + half_side_);
    }
    rod_ = half_flat_ == 0 && (path_.straight() || plan_length == 0);
}

double BeadField::planOffset(double x, double y) const {
    if (flats_.start == flats_.end) return path_.distance(x, y) - half_flat_;
    const double length = path_.length();
    const double ux = dx_ / length;
    const double uy = dy_ / length;
    const double along = (x - x0_) * ux + (y - y0_) * uy;
    const double across = std::abs((y - y0_) * ux - (x - x0_) * uy);
    const double slope = (flats_.end - flats_.start) / length;
    const double s = std::clamp(along + across * slope / std::sqrt(1 - slope * slope), 0.0, length);
    return std::hypot(along - s, across) - (flats_.start + slope * s);
}

double BeadField::distance(double x, double y, double z) const {
    if (rod_) {
        const double px = x - x0_;
        const double py = y - y0_;
        const double pz = z - zc0_;
        const double dz = zc1_ - zc0_;
        const double length2 = dx_ * dx_ + dy_ * dy_ + dz * dz;
        const double t = length2 > 0 ? std::clamp((px * dx_ + py * dy_ + pz * dz) / length2, 0.0, 1.0) : 0.0;
        const double qx = px - t * dx_;
        const double qy = py - t * dy_;
        const double qz = pz - t * dz;
        return std::sqrt(qx * qx + qy * qy + qz * qz) - radius_;
    }
    const double offset = planOffset(x, y);
    const double side = std::max(offset, 0.0);
    double up = 0;
    if (level_) {
        up = z - zc0_;
    } else {
        up = (z - std::lerp(zc0_, zc1_, path_.parameter(x, y))) * cosine_;
        if (up < 0) up = std::min(up + reach_, 0.0);
    }
    if (half_side_ == 0) return std::sqrt(side * side + up * up) - radius_;
    const double over = std::abs(up) - half_side_;
    return std::hypot(side, std::max(over, 0.0)) + std::min(std::max(offset, over), 0.0) - radius_;
}

std::optional<Extent> BeadField::heights(double x, double y) const {
    if (rod_) return rodHeights(x, y);
    const double offset = planOffset(x, y);
    if (!(offset < radius_)) return std::nullopt;
    const double side = std::max(offset, 0.0);
    const double half = half_side_ + std::sqrt((radius_ - side) * (radius_ + side));
    const double middle = level_ ? zc0_ : std::lerp(zc0_, zc1_, path_.parameter(x, y));
    return Extent{middle - (half + reach_) / cosine_, middle + half / cosine_};
}

// A capsule is the union of two balls and the cylinder between them, and convex: the lowest and the highest point of
// all three bound what the line meets.
std::optional<Extent> BeadField::rodHeights(double x, double y) const {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    Extent met{kNone, -kNone};
    const auto include = [&met](double low, double high) {
        met.z_min = std::min(met.z_min, low);
        met.z_max = std::max(met.z_max, high);
    };
    const auto ball = [&](double px, double py, double z) {
        const double rest = radius_ * radius_ - px * px - py * py;
        if (rest > 0) include(z - std::sqrt(rest), z + std::sqrt(rest));
    };
    const double px = x - x0_;
    const double py = y - y0_;
    ball(px, py, zc0_);
    ball(px - dx_, py - dy_, zc1_);
    const double dz = zc1_ - zc0_;
    const double plan2 = dx_ * dx_ + dy_ * dy_;
    const double length2 = plan2 + dz * dz;
    if (length2 > 0) {
        // With z from the start and t = (px dx + py dy + z dz)/length^2: |p|^2 - t^2 length^2 <= radius^2, 0 <= t <= 1.
        const double along = px * dx_ + py * dy_;
        const double across2 = plan2 > 0 ? (px * dy_ - py * dx_) * (px * dy_ - py * dx_) / plan2 : px * px + py * py;
        const double rest = radius_ * radius_ - across2;
        if (rest > 0) {
            double low = -kNone;
            double high = kNone;
            if (plan2 > 0) {
                const double middle = along * dz / plan2;
                const double half = std::sqrt(rest * length2 / plan2);
                low = middle - half;
                high = middle + half;
            }
            if (dz != 0) {
                const double from = -along / dz;
                const double to = (length2 - along) / dz;
                low = std::max(low, std::min(from, to));
                high = std::min(high, std::max(from, to));
            } else if (along < 0 || along > length2) {
                high = -kNone;
            }
            if (low < high) include(zc0_ + low, zc0_ + high);
        }
    }
    if (!(met.z_min < met.z_max)) return std::nullopt;
    return met;
}

Bounds BeadField::bounds() const {
    double plan_min[2];
    double plan_max[2];
    path_.bounds(plan_min, plan_max);
    const double side = std::max(flats_.start, flats_.end) + radius_;
    const double half_height = radius_ + half_side_;
    const double above = rod_ ? radius_ : half_height / cosine_;
    const double below = rod_ ? radius_ : (half_height + reach_) / cosine_;
    Bounds box;
    for (int axis = 0; axis < 2; ++axis) {
        box.min[axis] = plan_min[axis] - side;
        box.max[axis] = plan_max[axis] + side;
    }
    box.min[2] = std::min(zc0_, zc1_) - below;
    box.max[2] = std::max(zc0_, zc1_) + above;
    return box;
}

Bounds BeadField::bounds(double tilt) const {
    Bounds box = bounds();
    if (tilt == 0) return box;
    double plan_min[2];
    double plan_max[2];
    path_.bounds(plan_min, plan_max);
    const double flat = std::max(flats_.start, flats_.end);
    const double rise = rod_ ? 1 : 1 / cosine_;
    // How far the solid reaches along (0, y, z), a unit vector: the path, then the section around it.
    const auto reach = [&](double y, double z) {
        const double path = !path_.straight() ? y * (y > 0 ? plan_max[1] : plan_min[1]) + std::max(z * zc0_, z * zc1_)
                                              : std::max(y * y0_ + z * zc0_, y * (y0_ + dy_) + z * zc1_);
        return path + std::abs(y) * flat + radius_ * std::hypot(y, z * rise) + std::abs(z) * half_side_ * rise +
               (z < 0 ? -z * reach_ * rise : 0.0);
    };
    const double cosine = std::cos(tilt * std::numbers::pi / 180);
    const double sine = std::sin(tilt * std::numbers::pi / 180);
    box.min[1] = -reach(-cosine, sine);
    box.max[1] = reach(cosine, -sine);
    box.min[2] = -reach(-sine, -cosine);
    box.max[2] = reach(sine, cosine);
    return box;
}

Bounds boundsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> beads, double tilt) {
    constexpr std::size_t kGrain = 8192;
    Bounds all;
    std::mutex mutex;
    parallelFor(beads.size(), kGrain, [&](std::size_t first, std::size_t last) {
        Bounds part;
        for (const std::uint32_t bead : beads.subspan(first, last - first))
            part.include(BeadField(toolpath, toolpath.beads[bead]).bounds(tilt));
        const std::scoped_lock lock(mutex);
        all.include(part);
    });
    return all;
}

}  // namespace stratum::voxelize
