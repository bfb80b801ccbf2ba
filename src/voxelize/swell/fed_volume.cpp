#include "voxelize/swell/fed_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>

namespace stratum::voxelize {
namespace {

// Of a width: evenly, so that parallel lines lay the same everywhere.
constexpr std::array<double, 3> kAcross{-1.0 / 3, 0, 1.0 / 3};

struct Place {
    double x, y, ux, uy;
};

// `length`: of the path, or of a disc at its place, in the direction of x.
Place placeAt(const gcode::PlanPath& path, double t, double length) {
    if (!(path.length() > 0)) {
        const gcode::PlanPoint at = path.at(0);
        return {at.x + (t - 0.5) * length, at.y, 1, 0};
    }
    const double mm = t * path.length();
    const gcode::PlanPoint at = path.at(mm);
    const gcode::PlanPoint along = path.direction(mm);
    return {at.x, at.y, along.x, along.y};
}

}  // namespace

FedEnds fedEnds(const gcode::Toolpath& toolpath, std::uint32_t index) {
    if (toolpath.flow.empty()) return {};
    const auto meets = [&toolpath](std::uint32_t first) {
        constexpr double kSame = 1e-4;  // mm
        const gcode::Bead& a = toolpath.beads[first];
        const gcode::Bead& b = toolpath.beads[first + 1];
        return std::hypot(double{a.x1} - double{b.x0}, double{a.y1} - double{b.y0}) < kSame && a.z1 == b.z0;
    };
    return {index == 0 || !meets(index - 1), index + 1 == toolpath.beads.size() || !meets(index)};
}

FedVolume::FedVolume(const gcode::Toolpath& toolpath, const LayerStack& stack, TilePlace place)
    : toolpath_(toolpath),
      stack_(stack),
      first_x_(place.x * kSumCells),
      first_y_(place.y * kSumCells),
      spacing_(nodeSpacing(stack)),
      unit_(stack.settling_scale * stack.settling_scale) {}

void FedVolume::feed(std::uint32_t rank, std::span<TileSums::Node> nodes) const {
    const std::uint32_t index = stack_.beads[rank];
    const gcode::Bead& bead = toolpath_.beads[index];
    const double volume = gcode::laidVolume(toolpath_, index);
    const double height = 2 * stack_.layers[stack_.layer[rank]].halfHeight();
    const gcode::PlanPath path(toolpath_, bead);
    // A disc at a place is as long as it is wide.
    const double length =
        std::max(path.length(), std::min(std::sqrt(volume / height), static_cast<double>(bead.width)));
    if (!(volume > 0) || !(length > 0)) return;
    const double at_ends = feedEnds(index, volume, path, nodes);
    const double along = volume - at_ends;
    const double width = along / (height * length);
    const int steps = std::max(static_cast<int>(std::ceil(length / (0.5 * spacing_))), 1);
    const double part = along / (steps * static_cast<double>(kAcross.size()));
    // Of a bead that widens, the change from its start to its end as a share of its section.
    const double change = bead.arc < 0 && width > 0 ? gcode::widening(toolpath_, bead) / width : 0;
    const auto [from, to] = stepsInTile(bead, path, length, width, steps);
    const bool line = path.straight() && path.length() > 0;
    const Place start = placeAt(path, 0, length);
    for (int n = from; n < to; ++n) {
        const double t = (n + 0.5) / steps;
        // Of a line the direction is worked out once.
        const double mm = t * length;
        const Place place = line ? Place{start.x + mm * start.ux, start.y + mm * start.uy, start.ux, start.uy}
                                 : placeAt(path, t, length);
        const double here = part * (1 + change * (t - 0.5));
        for (const double side : kAcross) {
            const double aside = side * width;
            addPoint(place.x - aside * place.uy, place.y + aside * place.ux, here, nodes);
        }
    }
}

double FedVolume::feedEnds(std::uint32_t index, double volume, const gcode::PlanPath& path,
                           std::span<TileSums::Node> nodes) const {
    const gcode::Bead& bead = toolpath_.beads[index];
    const double discs = volume - gcode::beadVolume(toolpath_, bead);
    if (!(path.length() > 0) || !(discs > 0) || discs > 0.5 * volume) return 0;
    const FedEnds fed = fedEnds(toolpath_, index);
    const int ends = (fed.start ? 1 : 0) + (fed.end ? 1 : 0);
    if (ends == 0) return 0;
    const double width = static_cast<double>(bead.width);
    const double past = 2 * width / (3 * std::numbers::pi);  // the centroid of a half disc
    for (const bool at_end : {false, true}) {
        if (!(at_end ? fed.end : fed.start)) continue;
        const Place place = placeAt(path, at_end ? 1 : 0, 0);
        const double sign = at_end ? past : -past;
        for (const double side : kAcross) {
            const double aside = side * 0.8 * width;
            addPoint(place.x + sign * place.ux - aside * place.uy, place.y + sign * place.uy + aside * place.ux,
                     discs / (ends * static_cast<double>(kAcross.size())), nodes);
        }
    }
    return discs;
}

std::pair<int, int> FedVolume::stepsInTile(const gcode::Bead& bead, const gcode::PlanPath& path, double length,
                                           double width, int steps) const {
    double low = 0;
    double high = 1;
    const double more = width + length / steps;
    const auto withinSteps = [&]() -> std::pair<int, int> {
        if (low >= high) return {0, 0};
        return {std::max(static_cast<int>(std::floor(low * steps)) - 1, 0),
                std::min(static_cast<int>(std::ceil(high * steps)) + 1, steps)};
    };
    if (bead.arc >= 0) {
        if (!path.straight()) std::tie(low, high) = nearTile(path, more);
        return withinSteps();
    }
    const auto clip = [&](double from, double to, int first) {
        const double least = first * spacing_ - more;
        const double most = (first + kSumCells) * spacing_ + more;
        if (std::abs(to - from) < more) return;
        const double a = (least - from) / (to - from);
        const double b = (most - from) / (to - from);
        low = std::max(low, std::min(a, b));
        high = std::min(high, std::max(a, b));
    };
    clip(bead.x0, bead.x1, first_x_);
    clip(bead.y0, bead.y1, first_y_);
    return withinSteps();
}

// Seen from the center of an arc, the tile lies within an angle to both sides of its middle.
std::pair<double, double> FedVolume::nearTile(const gcode::PlanPath& path, double more) const {
    const double half = 0.5 * kSumCells * spacing_;
    const double x = first_x_ * spacing_ + half - path.center().x;
    const double y = first_y_ * spacing_ + half - path.center().y;
    const double away = std::hypot(x, y);
    const double reach = std::numbers::sqrt2 * half + more;
    if (away <= reach) return {0, 1};
    if (std::abs(away - path.radius()) > reach) return {0, 0};
    const double to_sides = std::asin(reach / away);
    const gcode::PlanPoint start = path.startSide();
    const double turn = std::abs(path.turn());
    // From the start, in the direction of its turn.
    double middle = std::atan2(start.x * y - start.y * x, start.x * x + start.y * y);
    if (path.turn() < 0) middle = -middle;
    double low = 1;
    double high = 0;
    for (middle -= 2 * std::numbers::pi; middle - to_sides < turn; middle += 2 * std::numbers::pi) {
        if (middle + to_sides < 0) continue;
        low = std::min(low, std::max(middle - to_sides, 0.0) / turn);
        high = std::max(high, std::min(middle + to_sides, turn) / turn);
    }
    return {low, high};
}

void FedVolume::addPoint(double x, double y, double volume, std::span<TileSums::Node> nodes) const {
    const double in_x = x * (1 / spacing_) - first_x_;
    const double in_y = y * (1 / spacing_) - first_y_;
    if (!(in_x >= 0 && in_x < kSumCells && in_y >= 0 && in_y < kSumCells)) return;
    const int i = static_cast<int>(in_x);
    const int j = static_cast<int>(in_y);
    const double fx = nodeShare(in_x - i);
    const double fy = nodeShare(in_y - j);
    const std::size_t at = nodeIndex(j, TileSums::kNodes, i);
    volume /= unit_;
    TileSums::Node* const node = &nodes[at];
    node[0].surplus += static_cast<float>(volume * (1 - fx) * (1 - fy));
    node[1].surplus += static_cast<float>(volume * fx * (1 - fy));
    node[TileSums::kNodes].surplus += static_cast<float>(volume * (1 - fx) * fy);
    node[TileSums::kNodes + 1].surplus += static_cast<float>(volume * fx * fy);
}

namespace {

bool samePlane(double a, double b) {
    constexpr double kSame = 1e-4;  // mm
    return std::abs(a - b) < kSame;
}

}  // namespace

void DirectOverlap::gather(const LeafColumn& column, std::span<const std::uint32_t> ranks) {
    pieces_.clear();
    const auto direct = std::lower_bound(ranks.begin(), ranks.end(), stack_.first_direct);
    for (const std::uint32_t rank : std::span(direct, ranks.end())) {
        const Extent& whole = stack_.extentOf(rank);
        if (whole.z_max <= low_ || whole.z_min >= high_) continue;
        const std::uint32_t bead = stack_.beads[rank];
        const BeadField field(toolpath_, toolpath_.beads[bead]);
        if (!field.level()) continue;
        const bool place = !(field.path().length() > 0);
        const FedEnds fed = fedEnds(toolpath_, bead);
        for (std::uint32_t c = 0; c < kColumnSamples; ++c) {
            const gcode::PlanPoint at = column.sample(c);
            const std::optional<Extent> extent = field.heights(at.x, at.y);
            if (!extent) continue;
            const double along = field.path().parameter(at.x, at.y);
            if (!place && ((along <= 0 && !fed.start) || (along >= 1 && !fed.end))) continue;
            pieces_.push_back({c, 0.5 * (extent->z_min + extent->z_max), extent->z_max - extent->z_min});
        }
    }
    // At a point the thickest of a plane is first, and holds the others.
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
        return a.point != b.point ? a.point < b.point : a.thickness > b.thickness;
    });
}

bool DirectOverlap::meets(const Layer& layer) const {
    return std::any_of(pieces_.begin(), pieces_.end(),
                       [&](const Piece& piece) { return samePlane(piece.center_z, layer.center_z); });
}

void DirectOverlap::share(const Layer& layer, std::array<PlanField, PressedLayer::kFields>& pressed,
                          PlanField& shared) const {
    shared = {};
    std::uint64_t done = 0;
    for (const Piece& piece : pieces_) {
        const std::uint64_t bit = std::uint64_t{1} << piece.point;
        if ((done & bit) != 0 || !samePlane(piece.center_z, layer.center_z)) continue;
        done |= bit;
        const auto thickness = static_cast<float>(piece.thickness);
        const float held = -pressed[0].v[piece.point];
        shared.v[piece.point] = std::min(thickness, held);
        for (std::size_t level = 1; level < pressed.size(); ++level) {
            float& gain = pressed[level].v[piece.point];
            gain -= std::min(thickness, held + gain) - shared.v[piece.point];
        }
    }
}

}  // namespace stratum::voxelize
