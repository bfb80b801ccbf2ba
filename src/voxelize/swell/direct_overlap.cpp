#include "voxelize/swell/direct_overlap.h"

#include "voxelize/swell/fed_volume.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace stratum::voxelize {
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
