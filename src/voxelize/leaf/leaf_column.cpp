#include "voxelize/leaf/leaf_column.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace stratum::voxelize {
namespace {

// How far planes that count as touching may be apart, for a layer of this half height (mm).
double weldGap(double half_height) { return kWeldGap * 2 * half_height; }

// Bounds of the work where far more beads than any print has lie in one column. Of more beads, those nearest to the
// column fill grooves; of more layers whose top planes meet one bottom plane, the nearest are welded.
constexpr std::ptrdiff_t kMostFilling = 512;
constexpr std::ptrdiff_t kMostPartners = 8;

// Whether the points of the plan are not the samples of leaves.
bool spreadOver(LeafColumn::Kind kind) {
    return kind == LeafColumn::Kind::spread || kind == LeafColumn::Kind::spread_without_swell;
}

}  // namespace

LeafRange leavesAround(const Lattice& lattice, double z_min, double z_max) {
    const double edge = lattice.voxel_size * kLeafDim;
    return {static_cast<int>(std::floor((z_min - lattice.background() - lattice.origin_z) / edge)),
            static_cast<int>(std::floor((z_max + lattice.background() - lattice.origin_z) / edge))};
}

LeafRange leavesAround(const Lattice& lattice, const LayerStack& stack) {
    double z_min = std::numeric_limits<double>::max();
    double z_max = std::numeric_limits<double>::lowest();
    for (const Layer& layer : stack.layers) {
        z_min = std::min(z_min, layer.bottom());
        z_max = std::max(z_max, layer.top());
    }
    for (const Extent& extent : stack.extents) {
        z_min = std::min(z_min, extent.z_min);
        z_max = std::max(z_max, extent.z_max);
    }
    return leavesAround(lattice, z_min, z_max);
}

LeafColumn::LeafColumn(const gcode::Toolpath& toolpath, const LayerStack& stack, const Lattice& lattice, double scale,
                       Kind kind)
    : toolpath_(toolpath),
      stack_(stack),
      lattice_(lattice),
      scale_(scale),
      band_(lattice.background()),
      with_swell_(stack.swell != nullptr && kind != Kind::spread_without_swell),
      grid_(spreadOver(kind) ? ColumnGrid::spread(static_cast<float>(lattice.voxel_size * scale))
                             : ColumnGrid(static_cast<float>(lattice.voxel_size * scale))),
      half_extent_(0.5 * (spreadOver(kind) ? kLeafDim + 1 : kLeafDim - 1) * lattice.voxel_size),
      slots_(kind == Kind::kept) {
    if (spreadOver(kind)) return;  // the rest is of leaves
    for (const Layer& layer : stack.layers) thickest_ = std::max(thickest_, layer.halfHeight() + layer.most_rise);
    weld_offsets_.assign(stack.layers.size() + 1, 0);
    for (const Weld& weld : stack.welds) ++weld_offsets_[weld.upper + 1];
    for (std::size_t i = 1; i < weld_offsets_.size(); ++i) weld_offsets_[i] += weld_offsets_[i - 1];
}

void LeafColumn::mergeRanges() {
    // Ranks of the layers come first, ascending.
    const auto rest = std::is_sorted_until(ranges_.begin(), ranges_.end());
    std::sort(rest, ranges_.end());
    std::inplace_merge(ranges_.begin(), rest, ranges_.end());
    std::size_t kept = 0;
    for (const LeafRange& range : ranges_) {
        if (kept > 0 && range.first <= ranges_[kept - 1].second + 1) {
            ranges_[kept - 1].second = std::max(ranges_[kept - 1].second, range.second);
        } else {
            ranges_[kept++] = range;
        }
    }
    ranges_.resize(kept);
}

std::span<const LeafRange> LeafColumn::bounds(std::span<const std::uint32_t> ranks) {
    ranges_.clear();
    std::uint32_t previous = std::numeric_limits<std::uint32_t>::max();
    for (const std::uint32_t rank : ranks) {
        if (rank >= stack_.first_direct) {
            const Extent& extent = stack_.extentOf(rank);
            ranges_.push_back(leafRange(extent.z_min, extent.z_max));
        } else if (stack_.layer[rank] != previous) {
            previous = stack_.layer[rank];
            const Layer& l = stack_.layers[previous];
            ranges_.push_back(leafRange(l.bottom(), l.top()));
        }
    }
    mergeRanges();
    return ranges_;
}

void LeafColumn::open(int i, int j, std::span<const std::uint32_t> ranks, std::uint32_t end) {
    i_ = i;
    j_ = j;
    leaf_k_ = std::numeric_limits<int>::min();
    constexpr double kMiddle = 0.5 * (kLeafDim - 1);
    middle_x_ = (i + kMiddle) * lattice_.voxel_size;
    middle_y_ = (j + kMiddle) * lattice_.voxel_size;
    ranks_ = ranks;
    end_ = end;
    column_layers_.clear();
    direct_.clear();
    next_layer_ = first_direct_ = 0;
    for (const std::uint32_t slot : window_) slots_.release(slot);
    swell_placed_ = false;
    window_.clear();
    by_layer_.clear();
    welds_.clear();
    half_heights_.clear();
    constexpr std::size_t kFew = 128;
    const bool few = ranks.size() <= kFew;
    std::uint32_t layer_end = 0;  // rank: of the last of column_layers_, so that only its first rank is looked up
    for (std::uint32_t e = 0; e < ranks.size(); ++e) {
        const std::uint32_t rank = ranks[e];
        if (stack_.beads[rank] >= end) continue;
        if (few) prefetchBead(toolpath_, stack_.beads[rank]);
        if (rank >= stack_.first_direct) {
            const Extent& extent = stack_.extentOf(rank);
            direct_.push_back({extent.z_min - band_, extent.z_max + band_, rank});
        } else if (rank >= layer_end) {
            const std::uint32_t layer = stack_.layer[rank];
            layer_end = stack_.layers[layer].last;
            column_layers_.push_back({layer, e, e + 1, false});
        } else {
            column_layers_.back().last = e + 1;
        }
    }
    // Ties are broken by rank, so that the order does not depend on the sort algorithm.
    std::sort(direct_.begin(), direct_.end(), [](const DirectBead& a, const DirectBead& b) {
        return std::pair{a.z_min, a.rank} < std::pair{b.z_min, b.rank};
    });
}

std::span<const LeafRange> LeafColumn::touched(std::uint32_t begin) {
    ranges_.clear();
    for (const ColumnLayer& source : column_layers_) {
        bool any = begin == 0;
        for (std::uint32_t e = source.first; !any && e < source.last; ++e) {
            const std::uint32_t bead = stack_.beads[ranks_[e]];
            any = bead >= begin && bead < end_;
        }
        if (!any) continue;
        const Layer& l = stack_.layers[source.layer];
        // A new bead can be welded to the layer below: up to its own center plane, so within its own band.
        const double gap = weldGap(l.halfHeight());
        ranges_.push_back(leafRange(l.bottom() - gap, l.top() + gap));
    }
    for (const DirectBead& direct : direct_)
        if (stack_.beads[direct.rank] >= begin)
            ranges_.push_back(leafRange(direct.z_min + band_, direct.z_max - band_));
    mergeRanges();
    return ranges_;
}

void LeafColumn::gatherPaths(const ColumnLayer& source, bool with_ranks) {
    const Layer& layer = stack_.layers[source.layer];
    lines_.clear();
    tapers_.clear();
    arcs_.clear();
    line_ids_.clear();
    taper_ids_.clear();
    arc_ids_.clear();
    for (std::uint32_t e = source.first; e < source.last; ++e) {
        const std::uint32_t rank = ranks_[e];
        constexpr std::uint32_t kAhead = 6;
        if (e + kAhead < ranks_.size()) prefetchBead(toolpath_, stack_.beads[ranks_[e + kAhead]]);
        if (stack_.beads[rank] >= end_) continue;
        const gcode::Bead& bead = toolpath_.beads[stack_.beads[rank]];
        const double half_flat = 0.5 * static_cast<double>(bead.width) - layer.inset;
        if (gcode::widening(toolpath_, bead) != 0) {
            const EndFlats flats = endFlats(toolpath_, bead, half_flat);
            tapers_.push_back(localTaper(bead, flats, middle_x_, middle_y_, half_extent_, scale_));
            if (with_ranks) taper_ids_.push_back(rank);
        } else if (const auto arc = arcOf(toolpath_, bead)) {
            arcs_.push_back(localArc(*arc, half_flat, middle_x_, middle_y_, half_extent_, scale_));
            if (with_ranks) arc_ids_.push_back(rank);
        } else {
            lines_.push_back(localLine(bead, half_flat, middle_x_, middle_y_, half_extent_, scale_));
            if (with_ranks) line_ids_.push_back(rank);
        }
    }
}

void LeafColumn::minimumOfPaths(PlanField& d, PlanOwners* owners) const {
    std::fill(std::begin(d.v), std::end(d.v), std::numeric_limits<float>::max());
    if (!lines_.empty()) minimumOfLines(grid_, lines_, d, line_ids_.data(), owners);
    if (!tapers_.empty()) minimumOfTapers(grid_, tapers_, d, taper_ids_.data(), owners);
    if (!arcs_.empty()) minimumOfArcs(grid_, arcs_, d, arc_ids_.data(), owners);
}

void LeafColumn::fillLayer(const ColumnLayer& source, PlanLayer& plan) {
    const Layer& layer = stack_.layers[source.layer];
    if (with_swell_) prefetchSwell(source.layer);
    gatherPaths(source, false);
    plan.layer = source.layer;
    plan.center_z = layer.center_z;
    plan.half_height = layer.halfHeight();
    plan.radius = layer.radius;
    plan.half_side = layer.half_side;
    plan.owned = plan.rises = false;
    plan.most_rise = 0;
    // Nothing of the column within the band: neither a surface nor a weld.
    const double reach = (layer.radius + band_) * scale_;
    float least = fieldOfPaths(layer, plan.d, plan.sides2);
    if (with_swell_) swell(source.layer, plan.d, plan.sides2, least);
    plan.beyond_band = static_cast<double>(least) >= reach * reach;
    if (!plan.beyond_band) plan.rises = with_swell_ && raise(source.layer, nearest_, plan.rise, plan.most_rise);
}

void LeafColumn::loadLayer(const ColumnLayer& source) {
    const PlanKey key{i_, j_, source.layer, end_};
    const std::uint32_t slot = slots_.take(key);
    PlanLayer& plan = slots_[slot];
    if (!slots_.isFilled(slot)) {
        fillLayer(source, plan);
        slots_.setFilled(slot, key);
    }
    if (plan.beyond_band) {
        slots_.release(slot);
        return;
    }
    window_.push_back(slot);
    const std::pair entry{source.layer, slot};
    by_layer_.insert(std::lower_bound(by_layer_.begin(), by_layer_.end(), entry), entry);
    if (std::find(half_heights_.begin(), half_heights_.end(), plan.half_height) == half_heights_.end())
        half_heights_.push_back(plan.half_height);
    addWelds(plan);
}

float LeafColumn::fieldOfPaths(const Layer& layer, PlanField& d, PlanField& sides2) {
    if (layer.settling == nullptr || lines_.size() + tapers_.size() + arcs_.size() < 2) {
        minimumOfPaths(d, nullptr);
        if (layer.crown > 0) nearest_ = d;
        return squaredSides(d, sides2);
    }
    const GrooveRule rule(*layer.settling, layer.radius * scale_);
    planPaths(&rule);
    minimumOfPaths(d, nullptr);
    minimumOfPlans(nearBeads(), d);
    if (layer.crown > 0) nearest_ = d;
    return fillBetweenNear(rule, d, sides2);
}

void LeafColumn::planPaths(const GrooveRule* rule) {
    near_count_ = 0;
    const double half_extent = half_extent_ * scale_;
    const auto move = [&](auto& paths, const auto& lineOf, const auto& planOf) {
        std::size_t left = rule != nullptr ? kMostFilling : paths.size();
        if (paths.size() > left) {
            const auto nearness = [&](const LocalLine& of) { return std::tuple{of.fromMiddle(), of.n0, of.ux, of.lo}; };
            std::nth_element(paths.begin(), paths.begin() + kMostFilling, paths.end(),
                             [&](const auto& a, const auto& b) { return nearness(lineOf(a)) < nearness(lineOf(b)); });
        }
        std::erase_if(paths, [&](const auto& path) {
            if (left == 0) return false;
            --left;
            const bool may_fill = rule == nullptr || mayFill(lineOf(path), *rule, half_extent);
            if (may_fill) planOf(grid_, path, nextNear());
            return may_fill;
        });
    };
    move(
        lines_, [](const LocalLine& line) -> const LocalLine& { return line; }, planOfLine);
    move(
        tapers_, [](const LocalTaper& taper) -> const LocalLine& { return taper.line; }, planOfTaper);
    for (const LocalArc& arc : arcs_) planOfArc(grid_, arc, nextNear());
    arcs_.clear();
}

float LeafColumn::fillBetweenNear(const GrooveRule& rule, PlanField& d, PlanField& sides2) {
    // Where flats are two radii apart or more, there is no groove to fill.
    filling_.clear();
    for (std::uint32_t n = 0; n < near_count_; ++n)
        if (near_[n].least < 2 * rule.radius) filling_.push_back(n);
    if (filling_.size() < 2) return squaredSides(d, sides2);
    if (filling_.size() > kMostFilling) {
        const auto nearest = filling_.begin() + kMostFilling;
        std::nth_element(filling_.begin(), nearest, filling_.end(), [this](std::uint32_t a, std::uint32_t b) {
            return std::pair{near_[a].least, a} < std::pair{near_[b].least, b};
        });
        filling_.erase(nearest, filling_.end());
    }
    PlanField levels;
    levelsBetween(near_, filling_, d, rule, levels);
    return fillGrooves(levels, rule, d, sides2);
}

void LeafColumn::addWelds(const PlanLayer& upper) {
    const double bottom = upper.center_z - upper.half_height;
    partners_.clear();
    // Both lists ascend by layer.
    auto present = by_layer_.begin();
    for (std::size_t w = weld_offsets_[upper.layer]; w < weld_offsets_[upper.layer + 1]; ++w) {
        const std::uint32_t lower = stack_.welds[w].lower;
        present = std::lower_bound(present, by_layer_.end(), std::pair{lower, std::uint32_t{0}});
        if (present == by_layer_.end()) break;
        if (present->first != lower) continue;
        const PlanLayer& below = slots_[present->second];
        partners_.emplace_back(std::abs(bottom - below.center_z - below.half_height), present - by_layer_.begin());
    }
    if (partners_.size() > kMostPartners) {
        const auto last = partners_.begin() + kMostPartners;
        std::nth_element(partners_.begin(), last, partners_.end());
        partners_.erase(last, partners_.end());
    }
    for (const auto& [gap, place] : partners_) {
        const PlanLayer& below = slots_[by_layer_[place].second];
        const double top = below.center_z + below.half_height;
        PlanWeld weld{std::min(top, bottom),
                      std::max(top, bottom),
                      0.5 * (below.center_z + upper.center_z),
                      0.5 * (upper.center_z - below.center_z),
                      {}};
        if (maximumOf(below.d, upper.d, weld.d) < 0) welds_.push_back(weld);
    }
}

void LeafColumn::moveWindow(double z_min, double z_max) {
    // A layer stays while its band reaches the leaf, and slightly longer, for welds to layers that rest on it.
    const auto reach = [this](double half_height) { return half_height + band_ + weldGap(half_height); };
    const auto passed = [&](std::uint32_t slot) {
        const PlanLayer& plan = slots_[slot];
        return plan.center_z + reach(plan.half_height) + plan.most_rise < z_min;
    };
    // In order, because the first of equally near beads is the owner.
    std::size_t kept = 0;
    for (const std::uint32_t slot : window_)
        if (passed(slot))
            slots_.release(slot);
        else
            window_[kept++] = slot;
    if (kept != window_.size()) {
        window_.resize(kept);
        std::erase_if(by_layer_, [&](const auto& entry) { return passed(entry.second); });
        half_heights_.clear();
        for (const std::uint32_t slot : window_)
            if (std::find(half_heights_.begin(), half_heights_.end(), slots_[slot].half_height) == half_heights_.end())
                half_heights_.push_back(slots_[slot].half_height);
    }
    std::erase_if(welds_, [&](const PlanWeld& weld) { return weld.interface_high + band_ < z_min; });
    // Layers ascend by center, but a thick one can reach lower than a thin one before it.
    for (std::size_t n = next_layer_; n < column_layers_.size(); ++n) {
        ColumnLayer& source = column_layers_[n];
        if (source.loaded) continue;
        const Layer& layer = stack_.layers[source.layer];
        if (layer.center_z - reach(thickest_) > z_max) break;
        if (layer.center_z - reach(layer.halfHeight()) > z_max) continue;
        source.loaded = true;
        if (layer.center_z + reach(layer.halfHeight()) + layer.most_rise >= z_min) loadLayer(source);
    }
    while (next_layer_ < column_layers_.size() && column_layers_[next_layer_].loaded) ++next_layer_;
}

void LeafColumn::gatherTerms(int k0) {
    terms_.clear();
    for (std::size_t z = 0; z < terms_.planes; ++z) {
        const double height = sampleZ(k0 + static_cast<int>(z));
        for (const double half_height : half_heights_) {
            const double reach = half_height + band_;
            const auto first = static_cast<std::uint32_t>(terms_.terms.size());
            double radius = 0;
            bool straight_sides = false;
            bool rises = false;
            for (const std::uint32_t slot : window_) {
                const PlanLayer& plan = slots_[slot];
                const double dz = height - plan.center_z;
                if (plan.half_height != half_height || dz <= -reach || dz >= reach + plan.most_rise) continue;
                radius = plan.radius;
                straight_sides = plan.half_side > 0;
                // Below the center plane nothing is moved.
                if (plan.rises && dz > 0) {
                    rises = true;
                    terms_.terms.push_back({&plan.sides2, 0, &plan.d, 0, &plan.rise, static_cast<float>(dz * scale_)});
                    continue;
                }
                if (!straight_sides) {
                    const auto world = static_cast<float>(dz * scale_);
                    terms_.terms.push_back({&plan.sides2, world * world});
                    continue;
                }
                // Written so that it is the radius, to the bit, on the planes of the flats.
                const auto over = static_cast<float>((radius - (half_height - std::abs(dz))) * scale_);
                const float above = std::max(over, 0.0F);
                terms_.terms.push_back({&plan.sides2, above * above, &plan.d, over});
            }
            const auto last = static_cast<std::uint32_t>(terms_.terms.size());
            if (first != last)
                terms_.groups.push_back({first, last, static_cast<float>(radius * scale_), straight_sides, rises,
                                         static_cast<float>((half_height - radius) * scale_)});
        }
        for (const PlanWeld& weld : welds_) {
            // Farther than the band from the interface the layer itself is deeper than the band.
            if (height < weld.interface_low - band_ || height > weld.interface_high + band_) continue;
            const double bound = std::abs(height - weld.middle_z) - weld.half;
            if (bound < 0) terms_.welds.push_back({&weld.d, static_cast<float>(bound * scale_)});
        }
        terms_.group_end[z] = static_cast<std::uint32_t>(terms_.groups.size());
        terms_.weld_end[z] = static_cast<std::uint32_t>(terms_.welds.size());
    }
}

LeafContent LeafColumn::evaluate(int leaf_k, std::size_t planes) {
    leaf_k_ = leaf_k;
    const int k0 = leaf_k * kLeafDim;
    const double z_min = sampleZ(k0);
    const double z_max = sampleZ(k0 + static_cast<int>(planes) - 1);
    terms_.planes = planes;
    moveWindow(z_min, z_max);
    const auto background = static_cast<float>(band_ * scale_);
    gatherTerms(k0);
    expandLayers(terms_, background, phi_);
    while (first_direct_ < direct_.size() && direct_[first_direct_].z_max < z_min) ++first_direct_;
    for (std::size_t n = first_direct_; n < direct_.size() && direct_[n].z_min <= z_max; ++n) {
        if (direct_[n].z_max < z_min) continue;
        expandDirect(direct_[n], k0, std::span(phi_.plane).first(kLeafPlanes));
        // Relative to the middle of the leaf above, so that the bits are those of that leaf.
        if (planes > kLeafPlanes) expandDirect(direct_[n], k0 + kLeafDim, std::span(phi_.plane).subspan(kLeafPlanes));
    }
    return clampLeaf(phi_, planes, background);
}

std::unique_ptr<Leaf> LeafColumn::makeLeaf() const {
    const auto background = static_cast<float>(band_ * scale_);
    const openvdb::Coord origin(i_, j_, leaf_k_ * kLeafDim);
    // A partial leaf: its values are not initialized, because they are written below.
    auto leaf = std::make_unique<Leaf>(openvdb::PartialCreate(), origin, background, false);
    leaf->allocate();
    std::uint64_t mask[Leaf::NodeMaskType::WORD_COUNT];
    storeValues(std::span<float, Leaf::SIZE>(leaf->buffer().data(), Leaf::SIZE), mask);
    for (openvdb::Index w = 0; w < Leaf::NodeMaskType::WORD_COUNT; ++w)
        leaf->getValueMask().getWord<openvdb::Index64>(w) = mask[w];
    return leaf;
}

void LeafColumn::storeValues(std::span<float, Leaf::SIZE> values, std::span<std::uint64_t, 8> active) const {
    storeLeaf(phi_, values.data());
    maskWithin(values.data(), static_cast<float>(band_ * scale_), active.data());
}

}  // namespace stratum::voxelize
