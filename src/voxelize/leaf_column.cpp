#include "voxelize/leaf_column.h"

#include "voxelize/bead_field.h"

#include <algorithm>
#include <cmath>

namespace stratum::voxelize {

LeafColumn::LeafColumn(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, double scale)
    : toolpath_(toolpath), stack_(stack), lattice_(lattice), scale_(scale) {
    weld_offsets_.assign(stack.layers.size() + 1, 0);
    for (const Weld& weld : stack.welds) ++weld_offsets_[weld.lower + 1];
    for (std::size_t i = 1; i < weld_offsets_.size(); ++i) weld_offsets_[i] += weld_offsets_[i - 1];
}

LeafColumn::LeafRange LeafColumn::leafRange(double z_min, double z_max) const {
    const double edge = lattice_.voxel_size * kLeafDim;
    const double band = lattice_.background();
    return {static_cast<int>(std::floor((z_min - band - lattice_.origin_z) / edge)),
            static_cast<int>(std::floor((z_max + band - lattice_.origin_z) / edge))};
}

std::size_t LeafColumn::countLeaves(std::span<const BinEntry> entries) {
    ranges_.clear();
    for (std::size_t e = 0; e < entries.size(); ++e) {
        const std::uint32_t layer = entries[e].layer;
        if (layer < stack_.layers.size()) {
            if (e > 0 && entries[e - 1].layer == layer) continue;
            const Layer& l = stack_.layers[layer];
            ranges_.push_back(leafRange(l.centre_z - l.radius, l.centre_z + l.radius));
        } else {
            const Bounds box = BeadField(toolpath_, toolpath_.beads[entries[e].bead]).bounds();
            ranges_.push_back(leafRange(box.min[2], box.max[2]));
        }
    }
    std::sort(ranges_.begin(), ranges_.end());
    std::size_t count = 0;
    std::size_t kept = 0;
    for (const LeafRange& range : ranges_) {
        if (kept > 0 && range.first <= ranges_[kept - 1].second) {
            ranges_[kept - 1].second = std::max(ranges_[kept - 1].second, range.second);
        } else {
            ranges_[kept++] = range;
        }
    }
    ranges_.resize(kept);
    for (const LeafRange& range : ranges_) count += static_cast<std::size_t>(range.second - range.first) + 1;
    return count;
}

void LeafColumn::gatherLayers(int i, int j, std::span<const BinEntry> entries) {
    layers_.clear();
    const double v = lattice_.voxel_size;
    for (std::size_t e = 0; e < entries.size();) {
        const std::uint32_t index = entries[e].layer;
        const Layer& layer = stack_.layers[index];
        PlanLayer plan{index, layer.centre_z, layer.radius, {}};
        plan.d.fill(std::numeric_limits<double>::max());
        for (; e < entries.size() && entries[e].layer == index; ++e) {
            const gcode::Bead& bead = toolpath_.beads[entries[e].bead];
            const PlanPath path(toolpath_, bead);
            const double half_flat = sectionOf(toolpath_, bead).half_flat;
            for (int x = 0; x < kLeafDim; ++x)
                for (int y = 0; y < kLeafDim; ++y) {
                    double& d = plan.d[column(x, y)];
                    d = std::min(d, path.distance((i + x) * v, (j + y) * v) - half_flat);
                }
        }
        layers_.push_back(plan);
    }
}

void LeafColumn::gatherWelds() {
    welds_.clear();
    for (const PlanLayer& lower : layers_) {
        for (std::size_t w = weld_offsets_[lower.layer]; w < weld_offsets_[lower.layer + 1]; ++w) {
            const std::uint32_t wanted = stack_.welds[w].upper;
            const auto upper =
                std::lower_bound(layers_.begin(), layers_.end(), wanted,
                                 [](const PlanLayer& layer, std::uint32_t value) { return layer.layer < value; });
            if (upper == layers_.end() || upper->layer != wanted) continue;
            PlanWeld weld{0.5 * (lower.centre_z + upper->centre_z), 0.5 * (upper->centre_z - lower.centre_z), {}};
            bool any = false;
            for (std::size_t c = 0; c < weld.d.size(); ++c) {
                weld.d[c] = std::max(lower.d[c], upper->d[c]);
                any = any || weld.d[c] < 0;
            }
            if (any) welds_.push_back(weld);
        }
    }
}

void LeafColumn::evaluate(int i, int j, int leaf_k, std::span<const BinEntry> direct) {
    const double v = lattice_.voxel_size;
    const double band = lattice_.background();
    const int k0 = leaf_k * kLeafDim;
    const double z_min = sampleZ(k0);
    const double z_max = sampleZ(k0 + kLeafDim - 1);
    phi_.fill(band);
    std::array<double, kLeafDim> dz{};

    for (const PlanLayer& layer : layers_) {
        const double reach = layer.radius + band;
        if (layer.centre_z - reach > z_max || layer.centre_z + reach < z_min) continue;
        for (int z = 0; z < kLeafDim; ++z) dz[static_cast<std::size_t>(z)] = sampleZ(k0 + z) - layer.centre_z;
        for (std::size_t c = 0; c < layer.d.size(); ++c) {
            if (layer.d[c] >= reach) continue;
            const double side = std::max(layer.d[c], 0.0);
            for (std::size_t z = 0; z < dz.size(); ++z) {
                double& phi = phi_[c * kLeafDim + z];
                phi = std::min(phi, std::sqrt(side * side + dz[z] * dz[z]) - layer.radius);
            }
        }
    }
    for (const PlanWeld& weld : welds_) {
        if (weld.middle_z - weld.half > z_max || weld.middle_z + weld.half < z_min) continue;
        for (std::size_t c = 0; c < weld.d.size(); ++c) {
            if (weld.d[c] >= 0) continue;
            for (int z = 0; z < kLeafDim; ++z) {
                // A bound, not a distance: taken only where it is negative, for far outside it can undercut.
                const double bound = std::max(weld.d[c], std::abs(sampleZ(k0 + z) - weld.middle_z) - weld.half);
                double& phi = phi_[c * kLeafDim + static_cast<std::size_t>(z)];
                if (bound < 0) phi = std::min(phi, bound);
            }
        }
    }
    for (const BinEntry& entry : direct) {
        const BeadField field(toolpath_, toolpath_.beads[entry.bead]);
        const Bounds box = field.bounds();
        if (box.min[2] - band > z_max || box.max[2] + band < z_min) continue;
        for (int x = 0; x < kLeafDim; ++x)
            for (int y = 0; y < kLeafDim; ++y)
                for (int z = 0; z < kLeafDim; ++z) {
                    double& phi = phi_[column(x, y) * kLeafDim + static_cast<std::size_t>(z)];
                    phi = std::min(phi, field.distance((i + x) * v, (j + y) * v, sampleZ(k0 + z)));
                }
    }
}

void LeafColumn::store(int i, int j, int leaf_k, ColumnLeaves& out) const {
    const double band = lattice_.background();
    const auto [lowest, highest] = std::minmax_element(phi_.begin(), phi_.end());
    if (*lowest >= band) return;
    const openvdb::Coord origin(i, j, leaf_k * kLeafDim);
    if (*highest <= -band) {
        out.inside_tiles.push_back(origin);
        return;
    }
    const auto background = static_cast<float>(band * scale_);
    auto* leaf = new Leaf(origin, background, false);
    float* values = leaf->buffer().data();
    auto& active = leaf->getValueMask();
    for (std::size_t n = 0; n < phi_.size(); ++n) {
        const auto value = static_cast<float>(phi_[n] * scale_);
        // After rounding: an active value must lie strictly within the background's magnitude.
        if (std::abs(value) < background) {
            values[n] = value;
            active.setOn(static_cast<openvdb::Index>(n));
        } else {
            values[n] = std::copysign(background, value);
        }
    }
    out.leaves.push_back(leaf);
}

void LeafColumn::build(int i, int j, std::span<const BinEntry> entries, ColumnLeaves& out) {
    const auto first_direct = std::find_if(
        entries.begin(), entries.end(), [this](const BinEntry& entry) { return entry.layer >= stack_.layers.size(); });
    const auto level = entries.first(static_cast<std::size_t>(first_direct - entries.begin()));
    const auto direct = entries.subspan(level.size());
    gatherLayers(i, j, level);
    gatherWelds();
    countLeaves(entries);
    for (const LeafRange& range : ranges_)
        for (int k = range.first; k <= range.second; ++k) {
            evaluate(i, j, k, direct);
            store(i, j, k, out);
        }
}

}  // namespace stratum::voxelize
