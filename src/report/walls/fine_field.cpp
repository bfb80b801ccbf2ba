#include "report/walls/fine_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::report {
namespace {

constexpr std::uint32_t kAllBeads = std::numeric_limits<std::uint32_t>::max();

}  // namespace

FineField::FineField(const gcode::Toolpath& toolpath, const voxelize::LayerStack& stack,
                     const voxelize::Lattice& lattice, const Part& part)
    : lattice_(lattice), part_(part), column_(toolpath, stack, lattice_, 1, voxelize::LeafColumn::Kind::kept) {
    const voxelize::Footprints footprints = voxelize::columnFootprints(toolpath, lattice_);
    const double band = 2 * lattice_.background();
    const auto isNear = [&](const gcode::Bead& bead) {
        if (bead.arc >= 0) return true;  // its box is not that of its ends
        // Of a line, with its width, and what settling moves.
        const double most = part.reach + 2 * static_cast<double>(bead.width) + band;
        return std::min(bead.x0, bead.x1) - most <= part.x && std::max(bead.x0, bead.x1) + most >= part.x &&
               std::min(bead.y0, bead.y1) - most <= part.y && std::max(bead.y0, bead.y1) + most >= part.y;
    };
    const auto take = [&](std::uint32_t rank) {
        const gcode::Bead& bead = toolpath.beads[stack.beads[rank]];
        if (!isNear(bead)) return;
        ranks_.push_back(rank);
        columns_.push_back(footprints.range(bead, footprints.limit(bead)));
    };
    for (const voxelize::Layer& layer : stack.layers)
        if (layer.top() + band >= part.z_min && layer.bottom() - band <= part.z_max)
            for (std::uint32_t rank = layer.first; rank < layer.last; ++rank) take(rank);
    for (std::uint32_t rank = stack.first_direct; rank < stack.beads.size(); ++rank) {
        const voxelize::Extent& extent = stack.extentOf(rank);
        if (extent.z_max + band >= part.z_min && extent.z_min - band <= part.z_max) take(rank);
    }
}

double FineField::value(const Point& p) {
    if (std::hypot(p.x - part_.x, p.y - part_.y) > part_.reach) return lattice_.background();
    return trilinear(lattice_, p, [this](int i, int j, int k) {
        const auto within = [](int sample) { return static_cast<std::size_t>(sample & (voxelize::kLeafDim - 1)); };
        const std::size_t index = voxelize::kLeafDim * (voxelize::kLeafDim * within(i) + within(j)) + within(k);
        return leafAt({i >> 3, j >> 3, k >> 3})[index];
    });
}

const FineField::Values& FineField::leafAt(const Place& place) {
    if (last_ != nullptr && place == last_place_) return *last_;
    const auto [found, added] = leaves_.try_emplace(place);
    if (added) make(place, found->second);
    last_place_ = place;
    last_ = &found->second;
    return *last_;
}

void FineField::make(const Place& place, Values& values) {
    const int i = place[0] * voxelize::kLeafDim;
    const int j = place[1] * voxelize::kLeafDim;
    if (!column_.mayEvaluate(i, j, kAllBeads, place[2])) open(i, j);
    const voxelize::LeafContent content = column_.evaluate(place[2]);
    if (content == voxelize::LeafContent::surface)
        voxelize::storeLeaf(column_.planes(), values.data());
    else
        values.fill(static_cast<float>(content == voxelize::LeafContent::inside ? -lattice_.background()
                                                                                : lattice_.background()));
}

void FineField::open(int i, int j) {
    const int column_i = i / voxelize::kLeafDim;
    const int column_j = j / voxelize::kLeafDim;
    const auto [found, added] = ranks_of_.try_emplace({column_i, column_j});
    if (added)
        for (std::size_t n = 0; n < ranks_.size(); ++n) {
            const voxelize::ColumnRange& range = columns_[n];
            if (column_i >= range.i0 && column_i <= range.i1 && column_j >= range.j0 && column_j <= range.j1)
                found->second.push_back(ranks_[n]);
        }
    column_.open(i, j, found->second, kAllBeads);
}

}  // namespace stratum::report
