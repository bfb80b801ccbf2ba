// Small toolpaths made by hand, and the brute-force field that the voxelizer is held against.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "study/geometry/handmade.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace stratum::test {

using study::addArc;
using study::addBead;
using study::allBeads;

/// The plan distance to a straight bead whose half flat changes linearly: the least over its discs. It is convex along
/// the path, so the sign of its slope is bisected.
struct TaperOffset {
    double d, at;  ///< mm; fraction of the path of the nearest disc
};
inline TaperOffset taperOffset(const gcode::Bead& bead, double start, double end, double x, double y) {
    const double ux = bead.x1 - bead.x0;
    const double uy = bead.y1 - bead.y0;
    const auto falls = [&](double t) {
        const double px = x - bead.x0 - t * ux;
        const double py = y - bead.y0 - t * uy;
        return -(px * ux + py * uy) < (end - start) * std::sqrt(px * px + py * py);
    };
    double low = 0;
    double high = 1;
    if (!falls(0)) high = 0;
    if (falls(1)) low = 1;
    while (high - low > 1e-13) {
        const double middle = 0.5 * (low + high);
        (falls(middle) ? low : high) = middle;
    }
    const double at = 0.5 * (low + high);
    return {std::hypot(x - bead.x0 - at * ux, y - bead.y0 - at * uy) - std::lerp(start, end, at), at};
}

/// The field of one level bead, written from the definition: nearest point of the path in the plane, then the formula.
/// Straight paths in closed form; arcs by turning to the chord-free polar form. Sloped beads are not covered.
inline double levelBeadDistance(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double x, double y,
                                double z) {
    double rho = 0;
    if (bead.arc < 0) {
        const double ux = bead.x1 - bead.x0;
        const double uy = bead.y1 - bead.y0;
        const double length = std::hypot(ux, uy);
        double along = 0;
        if (length > 0) along = std::min(std::max(((x - bead.x0) * ux + (y - bead.y0) * uy) / length, 0.0), length);
        const double nx = length > 0 ? bead.x0 + along * ux / length : double{bead.x0};
        const double ny = length > 0 ? bead.y0 + along * uy / length : double{bead.y0};
        rho = std::hypot(x - nx, y - ny);
    } else {
        const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
        const double radius = 0.5 * (std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y) +
                                     std::hypot(bead.x1 - arc.center_x, bead.y1 - arc.center_y));
        const double from = std::atan2(bead.y0 - arc.center_y, bead.x0 - arc.center_x);
        const double to = std::atan2(bead.y1 - arc.center_y, bead.x1 - arc.center_x);
        double turned = std::atan2(y - arc.center_y, x - arc.center_x) - from;
        if (arc.sweep < 0) turned = -turned;
        turned = std::fmod(turned + 4 * std::numbers::pi, 2 * std::numbers::pi);
        const auto to_point = [&](double angle) {
            return std::hypot(x - arc.center_x - radius * std::cos(angle), y - arc.center_y - radius * std::sin(angle));
        };
        rho = turned <= std::abs(arc.sweep) ? std::abs(std::hypot(x - arc.center_x, y - arc.center_y) - radius)
                                            : std::min(to_point(from), to_point(to));
    }
    const double height = std::round(static_cast<double>(toolpath.runOf(bead).height) * 1e6) * 1e-6;
    const double width = static_cast<double>(bead.width);
    const double radius = std::min(width, height) / 2;
    const double c = std::max(width - height, 0.0) / 2;
    double d = rho - c;
    if (const double more = gcode::widening(toolpath, bead); more != 0)
        d = taperOffset(bead, c - more / 4, c + more / 4, x, y).d;
    return std::hypot(std::max(d, 0.0), z - (bead.z0 - height / 2)) - radius;
}

/// Minimum over all level beads of a toolpath. Beads are looked at in short blocks, and blocks in groups, whose boxes
/// let most be passed over: the distance to a box is a lower bound for all beads in it, so the minimum is that of all
/// beads.
class BruteForce {
public:
    explicit BruteForce(const gcode::Toolpath& toolpath) : toolpath_(toolpath) {
        constexpr std::size_t kBlock = 8;
        constexpr std::size_t kGroup = 32;
        for (std::size_t first = 0; first < toolpath.beads.size(); first += kBlock) {
            Run block{first, std::min(first + kBlock, toolpath.beads.size())};
            for (std::size_t i = block.first; i < block.last; ++i) block.box.include(boxOf(toolpath.beads[i]));
            blocks_.push_back(block);
        }
        for (std::size_t first = 0; first < blocks_.size(); first += kGroup) {
            Run group{first, std::min(first + kGroup, blocks_.size())};
            for (std::size_t i = group.first; i < group.last; ++i) group.box.include(blocks_[i].box);
            groups_.push_back(group);
        }
    }

    double operator()(double x, double y, double z) const {
        const std::array<double, 3> p{x, y, z};
        double best = std::numeric_limits<double>::max();
        // The nearest group first: it bounds the others.
        std::vector<double> gaps;
        for (const Run& group : groups_) gaps.push_back(group.box.outside2(p));
        const auto nearest = static_cast<std::size_t>(std::min_element(gaps.begin(), gaps.end()) - gaps.begin());
        for (std::size_t k = 0; k < groups_.size(); ++k) {
            const std::size_t g = (nearest + k) % groups_.size();
            if (farther(gaps[g], best)) continue;
            for (std::size_t b = groups_[g].first; b < groups_[g].last; ++b) {
                const Run& block = blocks_[b];
                if (farther(block.box.outside2(p), best)) continue;
                for (std::size_t i = block.first; i < block.last; ++i)
                    best = std::min(best, levelBeadDistance(toolpath_, toolpath_.beads[i], x, y, z));
            }
        }
        return best;
    }

private:
    struct Box {
        std::array<double, 3> min{1e300, 1e300, 1e300}, max{-1e300, -1e300, -1e300};

        void include(const Box& other) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                min[axis] = std::min(min[axis], other.min[axis]);
                max[axis] = std::max(max[axis], other.max[axis]);
            }
        }
        /// The squared distance of a point; 0 inside.
        double outside2(const std::array<double, 3>& p) const {
            double sum = 0;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double gap = std::max({min[axis] - p[axis], p[axis] - max[axis], 0.0});
                sum += gap * gap;
            }
            return sum;
        }
    };
    /// Of beads, or of blocks.
    struct Run {
        std::size_t first, last;
        Box box{};
    };

    Box boxOf(const gcode::Bead& bead) const {
        const double height = static_cast<double>(toolpath_.runOf(bead).height);
        double side = static_cast<double>(bead.width) / 2;
        // Generous: an arc stays within its diameter of its start.
        if (bead.arc >= 0) {
            const gcode::Arc& arc = toolpath_.arcs[static_cast<std::size_t>(bead.arc)];
            side += 2 * std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
        }
        return {{std::min(bead.x0, bead.x1) - side, std::min(bead.y0, bead.y1) - side, bead.z0 - height - 1e-6},
                {std::max(bead.x0, bead.x1) + side, std::max(bead.y0, bead.y1) + side, bead.z0 + 1e-6}};
    }
    static bool farther(double outside2, double best) { return outside2 > 0 && (best < 0 || outside2 > best * best); }

    const gcode::Toolpath& toolpath_;
    std::vector<Run> blocks_, groups_;
};

}  // namespace stratum::test
