#include "voxelize/swell/direct_overlap.h"

#include "voxelize/swell/fed_volume.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

namespace stratum::voxelize {

void DirectOverlap::gather(const LeafColumn& column, std::span<const std::uint32_t> ranks) {
    pieces_.clear();
    lowest_ = std::numeric_limits<double>::max();
    highest_ = std::numeric_limits<double>::lowest();
    const auto direct = std::lower_bound(ranks.begin(), ranks.end(), stack_.first_direct);
    for (const std::uint32_t rank : std::span(direct, ranks.end())) {
        const Extent& whole = stack_.extentOf(rank);
        if (whole.z_max <= low_ || whole.z_min >= high_) continue;
        const std::uint32_t bead = stack_.beads[rank];
        const BeadField field(toolpath_, toolpath_.beads[bead]);
        const bool place = !(field.path().length() > 0);
        const FedEnds fed = field.level() ? fedEnds(toolpath_, bead) : FedEnds{};
        for (std::uint32_t c = 0; c < kColumnSamples; ++c) {
            const gcode::PlanPoint at = column.sample(c);
            const std::optional<Extent> extent = field.heights(at.x, at.y);
            if (!extent) continue;
            const double along = field.path().parameter(at.x, at.y);
            if (!place && ((along <= 0 && !fed.start) || (along >= 1 && !fed.end))) continue;
            pieces_.push_back({c, *extent});
            lowest_ = std::min(lowest_, extent->z_min);
            highest_ = std::max(highest_, extent->z_max);
        }
    }
    std::sort(pieces_.begin(), pieces_.end(), [](const Piece& a, const Piece& b) {
        return std::pair{a.point, a.extent.z_min} < std::pair{b.point, b.extent.z_min};
    });
    std::size_t kept = 0;
    for (const Piece& piece : pieces_) {
        if (kept > 0 && pieces_[kept - 1].point == piece.point && piece.extent.z_min <= pieces_[kept - 1].extent.z_max)
            pieces_[kept - 1].extent.z_max = std::max(pieces_[kept - 1].extent.z_max, piece.extent.z_max);
        else
            pieces_[kept++] = piece;
    }
    pieces_.resize(kept);
}

void DirectOverlap::share(const Layer& layer, std::array<PlanField, PressedLayer::kFields>& pressed,
                          PlanField& shared) const {
    shared = {};
    for (std::size_t n = 0; n < pieces_.size();) {
        const std::uint32_t c = pieces_[n].point;
        const std::size_t first = n;
        while (n < pieces_.size() && pieces_[n].point == c) ++n;
        // Of a section of that thickness.
        const auto sharedOf = [&](float thickness) {
            const double half = 0.5 * static_cast<double>(thickness);
            double sum = 0;
            for (std::size_t k = first; k < n; ++k)
                sum += std::max(std::min(pieces_[k].extent.z_max, layer.center_z + half) -
                                    std::max(pieces_[k].extent.z_min, layer.center_z - half),
                                0.0);
            return static_cast<float>(sum);
        };
        const float held = -pressed[0].v[c];
        shared.v[c] = sharedOf(held);
        for (std::size_t level = 1; level < pressed.size(); ++level) {
            float& gain = pressed[level].v[c];
            gain = std::max(gain - (sharedOf(held + gain) - shared.v[c]), 0.0F);
        }
    }
}

std::uint64_t DirectOverlap::covered(const Layer& layer) const {
    const double flat = layer.center_z + layer.halfHeight();
    std::uint64_t points = 0;
    for (const Piece& piece : pieces_)
        if (piece.extent.z_min < flat + 0.5 * layer.most_rise && piece.extent.z_max > flat)
            points |= std::uint64_t{1} << piece.point;
    return points;
}

}  // namespace stratum::voxelize
