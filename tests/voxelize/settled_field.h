// The field of a level print with any section, settled or not, in plain double loops over all beads: what the voxelizer
// is held against. Geometry, volumes and levels are computed here anew: distances by polar angles, areas by quadrature.
#pragma once

#include "toolpaths.h"
#include "voxelize/beads/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <vector>

namespace stratum::test {

/// A bead at a point of the plan: the distance beyond its flat, mm, and the direction from its path to the point.
struct BeadAtPoint {
    double d = 0, nx = 0, ny = 0;
};

/// The section of a layer, mm, and the volumes of grooves by quadrature.
class GrooveOracle {
public:
    GrooveOracle(double height, double radius) : height_(height), radius_(radius) {}

    double thickness(double d) const {
        if (d <= 0) return height_;
        return d < radius_ ? height_ - 2 * radius_ + 2 * std::sqrt(radius_ * radius_ - d * d) : 0;
    }
    double depth(double d) const { return d <= 0 ? 0 : height_ - thickness(std::min(d, radius_ * (1 - 1e-15))); }

    /// int_a^b f(d) dd by Gauss's rule in the angle, d = radius sin(angle), in which all integrands are smooth.
    template <typename Function>
    double integral(double a, double b, const Function& f) const {
        constexpr double kNodes[] = {0.1488743389816312, 0.4333953941292472, 0.6794095682990244, 0.8650633666889845,
                                     0.9739065285171717};
        constexpr double kWeights[] = {0.2955242247147529, 0.2692667193099964, 0.2190863625159820, 0.1494513491505806,
                                       0.0666713443086881};
        const double from = std::asin(std::clamp(a / radius_, 0.0, 1.0));
        const double to = std::asin(std::clamp(b / radius_, 0.0, 1.0));
        double sum = 0;
        constexpr int kParts = 8;
        for (int part = 0; part < kParts; ++part)
            for (int node = 0; node < 10; ++node) {
                const double sign = node < 5 ? -1 : 1;
                const double t = (part + 0.5 + 0.5 * sign * kNodes[node % 5]) / kParts;
                const double angle = from + (to - from) * t;
                sum += kWeights[node % 5] * f(radius_ * std::sin(angle)) * radius_ * std::cos(angle);
            }
        return sum * (to - from) / (2 * kParts);
    }

    double claimedTwice(double m) const {
        return 2 * integral(m, radius_, [this](double d) { return thickness(d * (1 - 1e-15)); });
    }
    double filled(double m, double level) const {
        return 2 * integral(level, m, [&](double d) { return depth(d) - depth(level); });
    }
    /// The level (mm) to which the groove over half a gap of m fills.
    double level(double m) const {
        if (m >= radius_) return radius_;
        const double claimed = claimedTwice(m);
        if (filled(m, 0) <= claimed) return 0;
        double low = 0;
        double high = m;
        for (int n = 0; n < 45; ++n) {
            const double middle = 0.5 * (low + high);
            (filled(m, middle) > claimed ? low : high) = middle;
        }
        return 0.5 * (low + high);
    }

    /// The same, interpolated between 2000 levels, dense at both ends: for many points.
    double quickLevel(double m) const {
        if (m >= radius_) return radius_;
        if (m <= closing_) return 0;
        const double at = 2 / std::numbers::pi * std::asin(std::sqrt((m - closing_) / (radius_ - closing_))) * kLevels;
        const auto node = std::min(static_cast<std::size_t>(at), levels_.size() - 2);
        return std::lerp(levels_[node], levels_[node + 1], at - static_cast<double>(node));
    }
    void prepare() {
        double low = 0;
        double high = radius_;
        for (int n = 0; n < 60; ++n) {
            const double middle = 0.5 * (low + high);
            (filled(middle, 0) < claimedTwice(middle) ? low : high) = middle;
        }
        closing_ = 0.5 * (low + high);
        for (int n = 0; n <= kLevels; ++n) {
            const double s = std::sin(0.5 * std::numbers::pi * n / kLevels);
            levels_.push_back(level(closing_ + (radius_ - closing_) * s * s));
        }
    }

private:
    static constexpr int kLevels = 2000;
    double height_, radius_;
    double closing_ = 0;
    std::vector<double> levels_;
};

/// Prepared once for each section.
inline const GrooveOracle& grooveOracle(double height, double radius) {
    static std::map<std::pair<double, double>, GrooveOracle> known;
    static std::mutex mutex;
    const std::scoped_lock lock(mutex);
    const auto [entry, fresh] = known.try_emplace({height, radius}, height, radius);
    if (fresh) entry->second.prepare();
    return entry->second;
}

class SettledField {
public:
    explicit SettledField(const gcode::Toolpath& toolpath)
        : toolpath_(toolpath),
          settles_(toolpath.deposit.settles()),
          stack_(voxelize::stackLayers(toolpath, allBeads(toolpath))) {
        double widest = 0;
        for (const gcode::Bead& bead : toolpath.beads) widest = std::max(widest, static_cast<double>(bead.width));
        reach_ = 2 * widest;
        cells_.resize(stack_.layers.size() + 1);
        for (const voxelize::Layer& layer : stack_.layers)
            grooves_.push_back(settles_ && layer.radius > 0
                                   ? &grooveOracle(2 * (layer.radius + layer.half_side), layer.radius)
                                   : nullptr);
        for (std::size_t l = 0; l < stack_.layers.size(); ++l)
            for (std::uint32_t rank = stack_.layers[l].first; rank < stack_.layers[l].last; ++rank) list(l, rank);
        for (std::uint32_t rank = stack_.first_direct; rank < stack_.beads.size(); ++rank)
            list(stack_.layers.size(), rank);
    }

    /// Points farther than the beads' width from the solid have at least that value.
    double operator()(double x, double y, double z) const {
        std::vector<double> weld(stack_.layers.size(), std::numeric_limits<double>::max());
        double phi = std::numeric_limits<double>::max();
        for (std::size_t l = 0; l < stack_.layers.size(); ++l) {
            const voxelize::Layer& layer = stack_.layers[l];
            const double half = layer.radius + layer.half_side;
            if (std::abs(z - layer.center_z) > 4 * half + reach_) continue;
            const auto [d, closed] = plan(l, x, y);
            weld[l] = closed;
            const double over = std::abs(z - layer.center_z) - layer.half_side;
            const double inside = layer.half_side > 0 ? std::min(std::max(closed, over), 0.0) : 0.0;
            phi = std::min(phi, std::hypot(std::max(d, 0.0), std::max(over, 0.0)) + inside - layer.radius);
        }
        // Level round beads, thinner than their layer.
        if (const auto found = cells_.back().find(cellOf(x, y)); found != cells_.back().end())
            for (const std::uint32_t rank : found->second)
                phi = std::min(phi, levelBeadDistance(toolpath_, toolpath_.beads[stack_.beads[rank]], x, y, z));
        for (const voxelize::Weld& pair : stack_.welds) {
            const voxelize::Layer& lower = stack_.layers[pair.lower];
            const voxelize::Layer& upper = stack_.layers[pair.upper];
            const double half = 0.5 * (upper.center_z - lower.center_z);
            const double bound = std::max(
                {weld[pair.lower], weld[pair.upper], std::abs(z - 0.5 * (lower.center_z + upper.center_z)) - half});
            if (bound < 0) phi = std::min(phi, bound);
        }
        return phi;
    }

private:
    using Cell = std::pair<int, int>;
    static constexpr double kCell = 1;  // mm

    static Cell cellOf(double x, double y) {
        return {static_cast<int>(std::floor(x / kCell)), static_cast<int>(std::floor(y / kCell))};
    }

    void list(std::size_t l, std::uint32_t rank) {
        const gcode::Bead& bead = toolpath_.beads[stack_.beads[rank]];
        double more = reach_;
        if (bead.arc >= 0) {
            const gcode::Arc& arc = toolpath_.arcs[static_cast<std::size_t>(bead.arc)];
            more += 2 * std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y);
        }
        const auto cell = [](double v) { return static_cast<int>(std::floor(v / kCell)); };
        for (int i = cell(std::min(bead.x0, bead.x1) - more); i <= cell(std::max(bead.x0, bead.x1) + more); ++i)
            for (int j = cell(std::min(bead.y0, bead.y1) - more); j <= cell(std::max(bead.y0, bead.y1) + more); ++j)
                cells_[l][{i, j}].push_back(rank);
    }

    BeadAtPoint beadAt(const voxelize::Layer& layer, std::uint32_t rank, double x, double y) const {
        const gcode::Bead& bead = toolpath_.beads[stack_.beads[rank]];
        double px = 0;
        double py = 0;
        if (bead.arc < 0) {
            const double ux = bead.x1 - bead.x0;
            const double uy = bead.y1 - bead.y0;
            const double length2 = ux * ux + uy * uy;
            const double t =
                length2 > 0 ? std::clamp(((x - bead.x0) * ux + (y - bead.y0) * uy) / length2, 0.0, 1.0) : 0.0;
            px = bead.x0 + t * ux;
            py = bead.y0 + t * uy;
        } else {
            const gcode::Arc& arc = toolpath_.arcs[static_cast<std::size_t>(bead.arc)];
            const double radius = 0.5 * (std::hypot(bead.x0 - arc.center_x, bead.y0 - arc.center_y) +
                                         std::hypot(bead.x1 - arc.center_x, bead.y1 - arc.center_y));
            const double from = std::atan2(bead.y0 - arc.center_y, bead.x0 - arc.center_x);
            const double to = std::atan2(bead.y1 - arc.center_y, bead.x1 - arc.center_x);
            double at = std::atan2(y - arc.center_y, x - arc.center_x);
            double turned = arc.sweep < 0 ? from - at : at - from;
            turned = std::fmod(turned + 4 * std::numbers::pi, 2 * std::numbers::pi);
            if (turned > std::abs(arc.sweep)) {
                const auto far = [&](double angle) {
                    return std::hypot(x - arc.center_x - radius * std::cos(angle),
                                      y - arc.center_y - radius * std::sin(angle));
                };
                at = far(from) < far(to) ? from : to;
            }
            px = arc.center_x + radius * std::cos(at);
            py = arc.center_y + radius * std::sin(at);
        }
        const double height = 2 * (layer.radius + layer.half_side);
        const double width = static_cast<double>(bead.width);
        // The flat that keeps the area of the stadium.
        const double area = height * (width - height * (1 - std::numbers::pi / 4));
        const double flat = (area + (4 - std::numbers::pi) * layer.radius * layer.radius) / height - 2 * layer.radius;
        if (const double more = gcode::widening(toolpath_, bead); more != 0) {
            const TaperOffset taper = taperOffset(bead, flat / 2 - more / 4, flat / 2 + more / 4, x, y);
            px = std::lerp(double{bead.x0}, double{bead.x1}, taper.at);
            py = std::lerp(double{bead.y0}, double{bead.y1}, taper.at);
            const double rho = std::hypot(x - px, y - py);
            return {taper.d, rho > 0 ? (x - px) / rho : 0, rho > 0 ? (y - py) / rho : 0};
        }
        const double rho = std::hypot(x - px, y - py);
        if (rho == 0) return {-flat / 2, 0, 0};
        return {rho - flat / 2, (x - px) / rho, (y - py) / rho};
    }

    // The plan distance, and the same closed where the groove is within what welds close.
    std::pair<double, double> plan(std::size_t l, double x, double y) const {
        const voxelize::Layer& layer = stack_.layers[l];
        const double radius = layer.radius;
        const auto found = cells_[l].find(cellOf(x, y));
        if (found == cells_[l].end()) return {1e9, 1e9};
        std::vector<BeadAtPoint> beads;
        double d = std::numeric_limits<double>::max();
        for (const std::uint32_t rank : found->second) {
            const BeadAtPoint bead = beadAt(layer, rank, x, y);
            d = std::min(d, bead.d);
            if (bead.d < 2 * radius) beads.push_back(bead);
        }
        double settled = d;
        double closed = d;
        if (!settles_ || d >= radius || !(radius > 0)) return {settled, closed};
        const double height = 2 * (radius + layer.half_side);
        const GrooveOracle& groove = *grooves_[l];
        // Both faces of a groove together are as deep as the gap that welds close.
        const double gap = voxelize::kWeldGap * height;
        const double weld = gap >= 2 * radius ? radius : std::sqrt(gap * (radius - gap / 4));
        for (std::size_t a = 0; a < beads.size(); ++a)
            for (std::size_t b = a + 1; b < beads.size(); ++b) {
                const double sum = std::max(beads[a].d, 0.0) + std::max(beads[b].d, 0.0);
                if (sum >= 2 * radius) continue;
                const double cosine = beads[a].nx * beads[b].nx + beads[a].ny * beads[b].ny;
                const double off = std::max((cosine + 0.9) / 0.9, 0.0);
                const double m = 0.5 * (sum + 2 * radius * off * off);
                if (m >= radius) continue;
                const double level = groove.quickLevel(m);
                settled = std::min(settled, level);
                closed = std::min(closed, level - weld * (1 - level / radius));
            }
        return {settled, closed};
    }

    const gcode::Toolpath& toolpath_;
    const bool settles_;
    const voxelize::LayerStack stack_;
    double reach_ = 0;
    std::vector<const GrooveOracle*> grooves_;
    std::vector<std::map<Cell, std::vector<std::uint32_t>>> cells_;  // ranks by layer and cell
};

}  // namespace stratum::test
