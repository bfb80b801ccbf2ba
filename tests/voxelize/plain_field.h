// The whole field of a level print in plain double loops, welds included: what the voxelizer is held against inside the
// solid, where the nearest bead alone does not tell the value.
#pragma once

#include "toolpaths.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/layer_stack.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace stratum::test {

class PlainField {
public:
    explicit PlainField(const gcode::Toolpath& toolpath)
        : toolpath_(toolpath), stack_(voxelize::stackLayers(toolpath, allBeads(toolpath))) {}

    double operator()(double x, double y, double z) const {
        std::vector<double> d(stack_.layers.size(), std::numeric_limits<double>::max());
        double phi = std::numeric_limits<double>::max();
        for (std::size_t l = 0; l < stack_.layers.size(); ++l) {
            const voxelize::Layer& layer = stack_.layers[l];
            for (std::uint32_t rank = layer.first; rank < layer.last; ++rank) {
                const std::uint32_t bead = stack_.beads[rank];
                const double rho = gcode::PlanPath(toolpath_, toolpath_.beads[bead]).distance(x, y);
                d[l] = std::min(d[l], rho - (toolpath_.beads[bead].width / 2 - layer.radius));
            }
            phi = std::min(phi, std::hypot(std::max(d[l], 0.0), z - layer.center_z) - layer.radius);
        }
        for (const voxelize::Weld& weld : stack_.welds) {
            const voxelize::Layer& lower = stack_.layers[weld.lower];
            const voxelize::Layer& upper = stack_.layers[weld.upper];
            const double half = 0.5 * (upper.center_z - lower.center_z);
            const double bound =
                std::max({d[weld.lower], d[weld.upper], std::abs(z - 0.5 * (lower.center_z + upper.center_z)) - half});
            if (bound < 0) phi = std::min(phi, bound);
        }
        return phi;
    }

private:
    const gcode::Toolpath& toolpath_;
    const voxelize::LayerStack stack_;
};

}  // namespace stratum::test
