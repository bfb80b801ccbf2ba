#include "report/walls/thinnest_wall.h"

#include "base/parallel_for.h"
#include "report/walls/bead_middle.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace stratum::report {
namespace {

constexpr std::size_t kPart = 4096;  // beads

class Ruler {
public:
    Ruler(const FieldProbe& probe, const BeadMiddle& middle, double voxel)
        : probe_(probe), middle_(middle), voxel_(voxel) {}

    Point at(double across) const {
        return {middle_.at.x + across * middle_.nx, middle_.at.y + across * middle_.ny, middle_.at.z};
    }
    // From the center line to the surface, mm; more than `most` if it is farther.
    double reach(double direction, double most) const {
        double inside = probe_.value(middle_.at);
        double from = 0;
        while (from <= most) {
            const double to = from + 0.5 * voxel_;
            const double value = probe_.value(at(direction * to));
            if (value >= 0) return from + (to - from) * inside / (inside - value);
            inside = value;
            from = to;
        }
        return std::numeric_limits<double>::infinity();
    }

private:
    const FieldProbe& probe_;
    const BeadMiddle& middle_;
    const double voxel_;
};

}  // namespace

std::optional<ThinnestWall> findThinnestWall(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                                             std::span<const std::uint32_t> selection, const voxelize::Lattice& lattice,
                                             const LeafMap& map, const Outside& outside) {
    ThinnestWall none;
    none.thickness = std::numeric_limits<double>::infinity();
    std::vector<ThinnestWall> parts((selection.size() + kPart - 1) / kPart, none);
    parallelFor(parts.size(), 1, [&](std::size_t begin, std::size_t end) {
        const FieldProbe probe(grid, lattice, map, &outside);
        for (std::size_t n = begin * kPart; n < std::min(end * kPart, selection.size()); ++n) {
            const gcode::Bead& bead = toolpath.beads[selection[n]];
            ThinnestWall& least = parts[n / kPart];
            const BeadMiddle middle = middleOf(toolpath, bead);
            if (middle.nx == 0 && middle.ny == 0) continue;
            const Ruler ruler(probe, middle, lattice.voxel_size);
            const double beside = 0.5 * static_cast<double>(bead.width) + lattice.voxel_size;
            if (!probe.isOutside(ruler.at(beside)) && !probe.isOutside(ruler.at(-beside))) continue;
            // Not of a bead that is lost between the samples.
            if (!(probe.value(middle.at) < 0)) continue;
            ++least.walls;
            const double left = ruler.reach(1, least.thickness);
            if (left > least.thickness) continue;
            const double thickness = left + ruler.reach(-1, least.thickness);
            if (thickness < least.thickness) {
                least.thickness = thickness;
                least.at = middle.at;
                least.bead = selection[n];
            }
        }
    });
    ThinnestWall least = none;
    for (const ThinnestWall& part : parts) {
        const std::size_t walls = least.walls + part.walls;
        if (part.thickness < least.thickness) least = part;
        least.walls = walls;
    }
    if (!std::isfinite(least.thickness)) return std::nullopt;
    return least;
}

}  // namespace stratum::report
