// The part of LeafColumn that measures: one layer over the open column, by plan.
#include "voxelize/leaf/leaf_column.h"

namespace stratum::voxelize {

LeafColumn::LayerPlan LeafColumn::planLayer(const ColumnLayer& source) {
    const Layer& layer = stack_.layers[source.layer];
    gatherPaths(source, true);
    line_ids_.insert(line_ids_.end(), taper_ids_.begin(), taper_ids_.end());
    line_ids_.insert(line_ids_.end(), arc_ids_.begin(), arc_ids_.end());
    planPaths(nullptr);
    minimumOfPaths(d_, nullptr);
    minimumOfPlans(nearBeads(), d_);
    if (with_swell_ && layer.crown > 0) nearest_ = d_;
    if (layer.settling != nullptr)
        fillBetweenNear(GrooveRule(*layer.settling, layer.radius * scale_), d_, sides2_);
    else
        squaredSides(d_, sides2_);
    swollen_ = sides2_;
    float least = 0;
    double most = 0;
    const bool swells = with_swell_ && swell(source.layer, d_, swollen_, least);
    const bool rises = with_swell_ && raise(source.layer, nearest_, rise_, most);
    return {&layer, line_ids_, nearBeads(), &sides2_, swells ? &swollen_ : nullptr, rises ? &rise_ : nullptr};
}

const PlanField& LeafColumn::fieldOf(const ColumnLayer& source) {
    const Layer& layer = stack_.layers[source.layer];
    gatherPaths(source, false);
    fieldOfPaths(layer, d_, sides2_);
    float least = 0;
    if (with_swell_) swell(source.layer, d_, sides2_, least);
    return d_;
}

}  // namespace stratum::voxelize
