#include "ondemand/print_field.h"

#include "base/parallel_for.h"
#include "ondemand/brick_map.h"
#include "voxelize/beads/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stratum::ondemand {
namespace {

// Distances to beads change by at most the way, and so does their least one. Around it there is no more than the gap
// that a weld closes and rounding. Filled grooves, ends that widen and helices have other fields.
double signSlackOf(const PrintLayout& layout) {
    const gcode::Toolpath& toolpath = *layout.toolpath;
    const auto other = [&toolpath](const gcode::Bead& bead) {
        return gcode::widening(toolpath, bead) != 0 || (bead.arc >= 0 && bead.z0 != bead.z1);
    };
    if (toolpath.deposit.settles() || std::any_of(toolpath.beads.begin(), toolpath.beads.end(), other))
        return std::numeric_limits<double>::infinity();
    double thickest = 0;
    for (const voxelize::Layer& layer : layout.stack.layers) thickest = std::max(thickest, 2 * layer.halfHeight());
    constexpr double kRounding = 0.01;  // of a voxel
    return (voxelize::kWeldGap * thickest + kRounding * layout.lattice.voxel_size) * layout.unit;
}

struct Worker {
    explicit Worker(const PrintLayout& layout) : maker(layout) {}
    LeafMaker maker;
    std::size_t made = 0;
};

}  // namespace

struct PrintField::Threads {
    explicit Threads(const PrintLayout& layout) : workers([&layout] { return Worker(layout); }) {}
    PerThread<Worker> workers;
};

PrintField::PrintField(std::shared_ptr<const gcode::Toolpath> toolpath, std::span<const std::uint32_t> selection,
                       const voxelize::Lattice& lattice, const voxelize::Placement& placement, std::string name)
    : transform_(voxelize::makeTransform(lattice, placement)),
      layout_(std::move(toolpath), selection, lattice, placement.unit),
      background_(static_cast<float>(lattice.background() * placement.unit)),
      sign_slack_(signSlackOf(layout_)),
      name_(std::move(name)),
      threads_(std::make_unique<Threads>(layout_)) {
    times_.bins = watch_.lap();
    active_ = findActiveBox(layout_);
    times_.box = watch_.lap();
    map_ = mapBricks(layout_, active_);
    times_.map = watch_.lap();
}

PrintField::~PrintField() = default;

LeafMaker& PrintField::maker() const { return threads_->workers.local().maker; }

bool PrintField::samples(const openvdb::Coord& origin, march::FieldSamples& out) const {
    Worker& worker = threads_->workers.local();
    ++worker.made;
    const voxelize::LeafContent content = worker.maker.make(origin, end_, voxelize::kMostPlanes);
    if (content == voxelize::LeafContent::outside) return false;
    const voxelize::LeafPlanes& planes = worker.maker.column().planes();
    voxelize::storeLeaf(planes, out.leaf.data());
    static_assert(voxelize::kColumnSamples == march::LeafSource::kCapSamples);
    std::copy_n(planes.plane[voxelize::kLeafPlanes].v, voxelize::kColumnSamples, out.above.data());
    return true;
}

std::vector<openvdb::Coord> PrintField::printUntil(std::uint32_t end) {
    const std::uint32_t from = std::min(end, end_);
    const std::uint32_t to = std::max(end, end_);
    end_ = end;
    const voxelize::LayerStack& stack = layout_.stack;
    const voxelize::Lattice& lattice = layout_.lattice;
    const double h = lattice.voxel_size;
    constexpr int kDim = voxelize::kLeafDim;
    const voxelize::Footprints footprints(*layout_.toolpath, kDim * h, 0.5 * (kDim - 1) * h, lattice.background(),
                                          voxelize::Footprints::Reach::field);
    const auto leafOf = [&](double z) { return static_cast<int>(std::floor((z - lattice.origin_z) / (kDim * h))); };
    std::vector<openvdb::Coord> leaves;
    for (std::uint32_t rank = 0; rank < stack.beads.size(); ++rank) {
        const std::uint32_t bead = stack.beads[rank];
        if (bead < from || bead >= to) continue;
        double z_min = 0;
        double z_max = 0;
        if (rank >= stack.first_direct) {
            const voxelize::Extent& extent = stack.extentOf(rank);
            z_min = extent.z_min - lattice.background();
            z_max = extent.z_max + lattice.background();
        } else {
            // A bead can be welded to the layer below it: within LeafColumn::touched().
            const voxelize::Layer& layer = stack.layers[stack.layer[rank]];
            const double around = 2 * voxelize::kWeldGap * layer.halfHeight() + lattice.background();
            z_min = layer.bottom() - around;
            z_max = layer.top() + around;
        }
        footprints.forEachColumn(layout_.toolpath->beads[bead], [&](int i0, int i1, int j) {
            for (int i = i0; i <= i1; ++i)
                for (int k = leafOf(z_min); k <= leafOf(z_max); ++k) leaves.emplace_back(i * kDim, j * kDim, k * kDim);
        });
    }
    std::sort(leaves.begin(), leaves.end());
    leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
    return leaves;
}

std::size_t PrintField::bytes() const {
    return layout_.bytes() + map_.bricks.masks.size() * (sizeof(std::uint64_t) + sizeof(std::uint32_t));
}

std::size_t PrintField::leavesMade() const {
    std::size_t made = 0;
    for (const Worker& worker : threads_->workers) made += worker.made;
    return made;
}

}  // namespace stratum::ondemand
