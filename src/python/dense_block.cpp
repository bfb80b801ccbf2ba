#include "python/dense_block.h"

#include "base/error.h"
#include "base/human_text.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "base/progress_meter.h"
#include "ondemand/print_layout.h"
#include "voxelize/beads/bead_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace stratum::python {

namespace {

constexpr int kDim = voxelize::kLeafDim;

int floorLeaf(int voxel) { return (voxel - (voxel < 0 ? kDim - 1 : 0)) / kDim; }

/// One pile of leaves of the box after the other.
class Pile {
public:
    Pile(const ondemand::PrintLayout& layout, const openvdb::CoordBBox& box, float* values)
        : layout_(layout), box_(box), values_(values) {
        const openvdb::Coord size = box.dim();
        stride_y_ = static_cast<std::size_t>(size[2]);
        stride_x_ = stride_y_ * static_cast<std::size_t>(size[1]);
    }

    // The columns of samples from (i, j), a leaf's first, on.
    void fill(int i, int j) {
        x0_ = std::max(i, box_.min()[0]);
        x1_ = std::min(i + kDim - 1, box_.max()[0]);
        y0_ = std::max(j, box_.min()[1]);
        y1_ = std::min(j + kDim - 1, box_.max()[1]);
        next_ = box_.min()[2];
        if (const auto bin = layout_.columnOf(i, j)) {
            voxelize::LeafColumn& column = layout_.columns.open(*bin);
            for (const voxelize::LeafRange& range : column.touched())
                for (int k = std::max(range.first, floorLeaf(box_.min()[2]));
                     k <= std::min(range.second, floorLeaf(box_.max()[2])); ++k)
                    put(column, i, j, k);
        }
        putConstant(box_.max()[2] + 1, background());
    }

private:
    float background() const { return static_cast<float>(layout_.lattice.background() * layout_.unit); }

    void put(voxelize::LeafColumn& column, int i, int j, int k) {
        putConstant(k * kDim, background());
        const voxelize::LeafContent content = column.evaluate(k);
        const int end = std::min(k * kDim + kDim, box_.max()[2] + 1);
        if (content != voxelize::LeafContent::surface) {
            putConstant(end, content == voxelize::LeafContent::inside ? -background() : background());
            return;
        }
        std::array<float, voxelize::Leaf::SIZE> leaf;
        std::array<std::uint64_t, kDim> active;
        column.storeValues(leaf, active);
        const int begin = std::max(next_, k * kDim);
        const float* const first = leaf.data() + (begin - k * kDim);
        for (int x = x0_; x <= x1_; ++x)
            for (int y = y0_; y <= y1_; ++y)
                std::copy_n(first + std::ptrdiff_t{kDim} * (kDim * (x - i) + (y - j)), end - begin, at(x, y, begin));
        next_ = end;
    }

    // Up to the sample before `end`.
    void putConstant(int end, float value) {
        end = std::min(end, box_.max()[2] + 1);
        if (end <= next_) return;
        for (int x = x0_; x <= x1_; ++x)
            for (int y = y0_; y <= y1_; ++y) std::fill_n(at(x, y, next_), end - next_, value);
        next_ = end;
    }

    float* at(int x, int y, int z) const {
        return values_ + static_cast<std::size_t>(x - box_.min()[0]) * stride_x_ +
               static_cast<std::size_t>(y - box_.min()[1]) * stride_y_ + static_cast<std::size_t>(z - box_.min()[2]);
    }

    const ondemand::PrintLayout& layout_;
    const openvdb::CoordBBox& box_;
    float* const values_;
    std::size_t stride_x_ = 0, stride_y_ = 0;
    int x0_ = 0, x1_ = 0, y0_ = 0, y1_ = 0;  // of the pile, inclusive
    int next_ = 0;                           // the first sample along z that is not written
};

}  // namespace

openvdb::CoordBBox samplesIn(const voxelize::Bounds& box, const voxelize::Lattice& lattice) {
    openvdb::CoordBBox samples;
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = axis == 2 ? lattice.origin_z : 0;
        // A face on a sample takes it, whatever rounding.
        constexpr double kSlack = 1e-6;
        const double low = std::ceil((box.min[axis] - origin) / lattice.voxel_size - kSlack);
        const double high = std::floor((box.max[axis] - origin) / lattice.voxel_size + kSlack);
        constexpr double kMost = 1e9;
        if (!(std::abs(low) < kMost && std::abs(high) < kMost))
            throw UsageError("box: is too far away; give two corners in mm, near the print");
        samples.min()[axis] = static_cast<int>(low);
        samples.max()[axis] = static_cast<int>(high);
    }
    return samples;
}

openvdb::CoordBBox samplesAround(const voxelize::Bounds& solid, const voxelize::Lattice& lattice) {
    voxelize::Bounds box = solid;
    for (int axis = 0; axis < 3; ++axis) {
        box.min[axis] -= lattice.background();
        box.max[axis] += lattice.background();
    }
    return samplesIn(box, lattice);
}

void requireFits(const openvdb::CoordBBox& box) {
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) {
        const double size = 1.0 + box.max()[axis] - box.min()[axis];
        if (!(size > 0)) throw UsageError("box: has no sample inside; make it larger than a voxel");
        count *= size;
    }
    requireMemory(count * sizeof(float), fmt::format("a dense block of {}", humanCount(count)),
                  "choose a smaller box or larger voxels, or take the sparse level set of voxelize()");
}

void fillDense(const std::shared_ptr<const gcode::Toolpath>& toolpath, std::span<const std::uint32_t> selection,
               const voxelize::Lattice& lattice, const openvdb::CoordBBox& box, float* values,
               const std::function<void(double)>& progress) {
    const ondemand::PrintLayout layout(toolpath, selection, lattice, 1);
    const int first_i = floorLeaf(box.min()[0]);
    const int first_j = floorLeaf(box.min()[1]);
    const int last_i = floorLeaf(box.max()[0]);
    const int last_j = floorLeaf(box.max()[1]);
    const std::size_t along_i = static_cast<std::size_t>(last_i) - static_cast<std::size_t>(first_i) + 1;
    const std::size_t along_j = static_cast<std::size_t>(last_j) - static_cast<std::size_t>(first_j) + 1;
    ProgressMeter meter(along_i * along_j, progress);
    parallelFor(along_i * along_j, 1, [&](std::size_t first, std::size_t last) {
        Pile pile(layout, box, values);
        for (std::size_t n = first; n < last; ++n)
            pile.fill((first_i + static_cast<int>(n / along_j)) * kDim,
                      (first_j + static_cast<int>(n % along_j)) * kDim);
        meter.advance(last - first);
    });
}

}  // namespace stratum::python
