#include "voxelize/grid/solid_check.h"

#include "voxelize/beads/bead_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stratum::voxelize {
namespace {

constexpr std::size_t kPlaces = 16;
constexpr std::size_t kInARow = 32;

struct Point {
    double x, y, z;
};

// The point halfway along a bead's center line.
Point middleOf(const gcode::Toolpath& toolpath, const gcode::Bead& bead) {
    const double z = 0.5 * (bead.z0 + bead.z1) - sectionOf(toolpath, bead).drop;
    const gcode::PlanPath path(toolpath, bead);
    const gcode::PlanPoint place = path.at(0.5 * path.length());
    return {place.x, place.y, z};
}

struct Nearby {
    BeadField field;
    Bounds box;  // of the solid
};

bool within(const Bounds& box, const Point& p, double reach) {
    return p.x > box.min[0] - reach && p.x < box.max[0] + reach && p.y > box.min[1] - reach &&
           p.y < box.max[1] + reach && p.z > box.min[2] - reach && p.z < box.max[2] + reach;
}

// Trilinear between the eight samples around `p`, of the union of `beads`.
double fieldAt(const std::vector<Nearby>& beads, const Lattice& lattice, const Point& p) {
    const double h = lattice.voxel_size;
    const double at[3] = {p.x / h, p.y / h, (p.z - lattice.origin_z) / h};
    std::vector<const BeadField*> close;
    for (const Nearby& bead : beads)
        if (within(bead.box, p, 3 * h)) close.push_back(&bead.field);
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        double sample[3];
        for (int axis = 0; axis < 3; ++axis) {
            const double floor = std::floor(at[axis]);
            const int step = corner >> axis & 1;
            weight *= step != 0 ? at[axis] - floor : 1 - (at[axis] - floor);
            sample[axis] = (floor + step) * h;
        }
        double least = lattice.background();
        for (const BeadField* field : close)
            least = std::min(least, field->distance(sample[0], sample[1], sample[2] + lattice.origin_z));
        sum += weight * least;
    }
    return sum;
}

}  // namespace

double lostShare(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice) {
    const std::size_t places = std::min(kPlaces, selection.size());
    const double reach = 3 * lattice.voxel_size;
    std::size_t asked = 0;
    std::size_t lost = 0;
    for (std::size_t place = 0; place < places; ++place) {
        const std::size_t first = selection.size() * place / places;
        const std::size_t next = selection.size() * (place + 1) / places;
        const std::size_t count = std::min(kInARow, next - first);
        const std::span<const std::uint32_t> sample = selection.subspan(first + (next - first - count) / 2, count);
        Bounds around = boundsOf(toolpath, sample);
        for (int axis = 0; axis < 3; ++axis) around.min[axis] -= reach, around.max[axis] += reach;
        std::vector<Nearby> near;
        for (const std::uint32_t index : selection) {
            const gcode::Bead& bead = toolpath.beads[index];
            // Filters by height first, without evaluating fields, with a margin of half a bead's width above and below.
            const double margin = static_cast<double>(toolpath.runOf(bead).height) + static_cast<double>(bead.width);
            if (std::max<double>(bead.z0, bead.z1) + margin < around.min[2] ||
                std::min<double>(bead.z0, bead.z1) - margin > around.max[2])
                continue;
            const BeadField field(toolpath, bead);
            const Bounds box = field.bounds();
            bool meets = true;
            for (int axis = 0; axis < 3; ++axis)
                meets = meets && box.min[axis] <= around.max[axis] && box.max[axis] >= around.min[axis];
            if (meets) near.push_back({field, box});
        }
        for (const std::uint32_t index : sample) {
            ++asked;
            lost += fieldAt(near, lattice, middleOf(toolpath, toolpath.beads[index])) >= 0 ? 1 : 0;
        }
    }
    return asked > 0 ? static_cast<double>(lost) / static_cast<double>(asked) : 0;
}

double depositedVolume(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    double sum = 0;
    for (const std::uint32_t index : selection) sum += gcode::laidVolume(toolpath, index);
    return sum;
}

}  // namespace stratum::voxelize
