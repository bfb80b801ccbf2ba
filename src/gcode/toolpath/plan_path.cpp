#include "gcode/toolpath/plan_path.h"

#include <numbers>

namespace stratum::gcode {

PlanPath::PlanPath(const Toolpath& toolpath, const Bead& bead)
    : x0_(bead.x0), y0_(bead.y0), x1_(bead.x1), y1_(bead.y1), dx_(x1_ - x0_), dy_(y1_ - y0_) {
    const double length2 = dx_ * dx_ + dy_ * dy_;
    inverse_length2_ = length2 > 0 ? 1.0 / length2 : 0.0;
    length_ = std::sqrt(length2);
    if (bead.arc < 0) return;
    const Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    center_ = {arc.center_x, arc.center_y};
    const double start = std::hypot(x0_ - center_.x, y0_ - center_.y);
    const double end = std::hypot(x1_ - center_.x, y1_ - center_.y);
    if (!(start > 0) || !(end > 0)) return;
    sweep_ = arc.sweep;
    radius_ = 0.5 * (start + end);
    start_.x = (x0_ - center_.x) / start;
    start_.y = (y0_ - center_.y) / start;
    end_.x = (x1_ - center_.x) / end;
    end_.y = (y1_ - center_.y) / end;
    length_ = radius_ * std::abs(sweep_);
}

PlanPoint PlanPath::at(double mm) const {
    if (length_ == 0) return {x0_, y0_};
    if (straight()) return {x0_ + mm * (dx_ / length_), y0_ + mm * (dy_ / length_)};
    const double angle = mm / length_ * sweep_;
    const double cosine = radius_ * std::cos(angle);
    const double sine = radius_ * std::sin(angle);
    return {center_.x + cosine * start_.x - sine * start_.y, center_.y + sine * start_.x + cosine * start_.y};
}

PlanPoint PlanPath::direction(double mm) const {
    if (length_ == 0) return {};
    if (straight()) return {dx_ / length_, dy_ / length_};
    const double angle = mm / length_ * sweep_;
    const double turn = sweep_ < 0 ? -1.0 : 1.0;
    const double cosine = turn * std::cos(angle);
    const double sine = turn * std::sin(angle);
    return {-(sine * start_.x + cosine * start_.y), cosine * start_.x - sine * start_.y};
}

bool PlanPath::withinSweep(double vx, double vy) const {
    const double turn = sweep_ < 0 ? -1.0 : 1.0;
    const double past_start = turn * (start_.x * vy - start_.y * vx);
    const double before_end = turn * (vx * end_.y - vy * end_.x);
    // The wedge of up to half a turn is an intersection of two half planes, the wider one is a union.
    if (std::abs(sweep_) <= std::numbers::pi) return past_start >= 0 && before_end >= 0;
    return past_start >= 0 || before_end >= 0 || std::abs(sweep_) >= 2 * std::numbers::pi;
}

double PlanPath::arcDistance(double x, double y) const {
    const double vx = x - center_.x;
    const double vy = y - center_.y;
    if (withinSweep(vx, vy)) return std::abs(std::sqrt(vx * vx + vy * vy) - radius_);
    const double to_start = std::hypot(vx - radius_ * start_.x, vy - radius_ * start_.y);
    const double to_end = std::hypot(vx - radius_ * end_.x, vy - radius_ * end_.y);
    return std::min(to_start, to_end);
}

double PlanPath::parameter(double x, double y) const {
    if (radius_ > 0) {
        const double vx = x - center_.x;
        const double vy = y - center_.y;
        if (!withinSweep(vx, vy)) {
            const double to_start = std::hypot(vx - radius_ * start_.x, vy - radius_ * start_.y);
            const double to_end = std::hypot(vx - radius_ * end_.x, vy - radius_ * end_.y);
            return to_start <= to_end ? 0.0 : 1.0;
        }
        const double turn = sweep_ < 0 ? -1.0 : 1.0;
        double angle = turn * std::atan2(start_.x * vy - start_.y * vx, start_.x * vx + start_.y * vy);
        if (angle < 0) angle += 2 * std::numbers::pi;
        return std::clamp(angle / std::abs(sweep_), 0.0, 1.0);
    }
    return std::clamp(((x - x0_) * dx_ + (y - y0_) * dy_) * inverse_length2_, 0.0, 1.0);
}

double PlanPath::nearest(double x, double y) const { return parameter(x, y) * length_; }

void PlanPath::bounds(double (&min)[2], double (&max)[2]) const {
    min[0] = std::min(x0_, x1_);
    min[1] = std::min(y0_, y1_);
    max[0] = std::max(x0_, x1_);
    max[1] = std::max(y0_, y1_);
    if (radius_ == 0) return;
    if (withinSweep(1, 0)) max[0] = std::max(max[0], center_.x + radius_);
    if (withinSweep(-1, 0)) min[0] = std::min(min[0], center_.x - radius_);
    if (withinSweep(0, 1)) max[1] = std::max(max[1], center_.y + radius_);
    if (withinSweep(0, -1)) min[1] = std::min(min[1], center_.y - radius_);
}

}  // namespace stratum::gcode
