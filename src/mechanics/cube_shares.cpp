#include "mechanics/cube_shares.h"

#include "base/memory.h"
#include "base/parallel_for.h"
#include "voxelize/beads/bead_field.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/leaf/print_columns.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace stratum::mechanics {
namespace {

using voxelize::kColumnSamples;
using voxelize::kLeafDim;
using voxelize::PlanField;

constexpr double kLinesPerLayer = 8;
constexpr int kFewestLines = 3;
// Lengths are summed as whole numbers, so that their order does not matter.
constexpr double kUnits = 1 << 20;

// What the lines of one column of leaves say of a cube.
struct PartOfCube {
    std::int32_t i = 0, j = 0, k = 0;
    std::uint8_t reached = 0;
    std::uint64_t length = 0;  // of lines inside the solid, in edges / kUnits

    auto place() const { return std::tie(k, j, i); }
};

// Parts of one cube become one.
void join(std::vector<PartOfCube>& parts) {
    std::size_t kept = 0;
    for (const PartOfCube& part : parts) {
        if (kept > 0 && parts[kept - 1].place() == part.place()) {
            parts[kept - 1].length += part.length;
            parts[kept - 1].reached |= part.reached;
        } else {
            parts[kept++] = part;
        }
    }
    parts.resize(kept);
}

bool before(const PartOfCube& a, const PartOfCube& b) { return a.place() < b.place(); }

// Inside the solid, along a vertical line, mm.
struct Inside {
    double from, to;
};

class ColumnReader {
public:
    /// `lines`: along each edge of a cube, odd. `gap`: mm, the plastic of layers that are so near is one.
    ColumnReader(const voxelize::PrintColumns& columns, const CubeShares& cubes, int lines, double gap)
        : toolpath_(columns.toolpath()),
          bins_(columns.bins()),
          stack_(columns.stack()),
          cubes_(cubes),
          lines_(lines),
          gap_(gap) {}

    /// Of the open column `n`.
    void read(std::size_t n, voxelize::LeafColumn& column, std::vector<PartOfCube>& out) {
        for (std::vector<Inside>& line : inside_) line.clear();
        parts_.clear();
        const int i = bins_.originI(n);
        const int j = bins_.originJ(n);
        column.forEachField([this](std::uint32_t layer, const PlanField& d) { addLayer(stack_.layers[layer], d); });
        for (const std::uint32_t rank : bins_[n])
            if (rank >= stack_.first_direct) addBead(toolpath_.beads[stack_.beads[rank]], i, j);
        for (std::size_t c = 0; c < kColumnSamples; ++c)
            measure(i + static_cast<int>(c / kLeafDim), j + static_cast<int>(c % kLeafDim), inside_[c]);
        std::sort(parts_.begin(), parts_.end(), before);
        join(parts_);
        out.assign(parts_.begin(), parts_.end());
    }

private:
    double step() const { return cubes_.edge / lines_; }

    void addLayer(const voxelize::Layer& layer, const PlanField& d) {
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double beyond = std::max(static_cast<double>(d.v[c]), 0.0);
            if (beyond >= layer.radius && d.v[c] > 0) continue;
            const double half = layer.half_side + std::sqrt(layer.radius * layer.radius - beyond * beyond);
            inside_[c].push_back({layer.center_z - half, layer.center_z + half});
        }
    }

    void addBead(const gcode::Bead& bead, int i, int j) {
        const voxelize::BeadField field(toolpath_, bead);
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double x = (i + static_cast<int>(c / kLeafDim)) * step();
            const double y = (j + static_cast<int>(c % kLeafDim)) * step();
            if (const auto met = field.heights(x, y)) inside_[c].push_back({met->z_min, met->z_max});
        }
    }

    void measure(int i, int j, std::vector<Inside>& line) {
        if (line.empty()) return;
        std::sort(line.begin(), line.end(), [](const Inside& a, const Inside& b) { return a.from < b.from; });
        PartOfCube part;
        part.i = cubeOf(i);
        part.j = cubeOf(j);
        std::uint8_t sides = 0;
        if (i == part.i * lines_ - lines_ / 2) sides |= 1U << x_low;
        if (i == part.i * lines_ + lines_ / 2) sides |= 1U << x_high;
        if (j == part.j * lines_ - lines_ / 2) sides |= 1U << y_low;
        if (j == part.j * lines_ + lines_ / 2) sides |= 1U << y_high;
        Inside whole = line.front();
        for (const Inside& next : line) {
            if (next.from <= whole.to + gap_) {
                whole.to = std::max(whole.to, next.to);
                continue;
            }
            divide(whole, part, sides);
            whole = next;
        }
        divide(whole, part, sides);
    }

    // The cubes that a stretch goes through.
    void divide(const Inside& whole, PartOfCube part, std::uint8_t sides) {
        const double from = (whole.from - cubes_.origin[2]) / cubes_.edge;
        const double to = (whole.to - cubes_.origin[2]) / cubes_.edge;
        const auto end = static_cast<std::int32_t>(std::ceil(to));
        for (auto k = static_cast<std::int32_t>(std::floor(from)); k < end; ++k) {
            const double length = std::min(to, k + 1.0) - std::max<double>(from, k);
            part.length = static_cast<std::uint64_t>(std::llround(length * kUnits));
            if (part.length == 0) continue;
            part.k = k;
            part.reached = sides;
            if (from < k) part.reached |= 1U << z_low;
            if (to > k + 1) part.reached |= 1U << z_high;
            parts_.push_back(part);
        }
    }

    int cubeOf(int line) const {
        const int from = line + lines_ / 2;
        return from >= 0 ? from / lines_ : -((lines_ - 1 - from) / lines_);
    }

    const gcode::Toolpath& toolpath_;
    const voxelize::PlanBins& bins_;
    const voxelize::LayerStack& stack_;
    const CubeShares& cubes_;
    const int lines_;
    const double gap_;
    std::array<std::vector<Inside>, kColumnSamples> inside_;
    std::vector<PartOfCube> parts_;  // of the open column
};

}  // namespace

CubeShares cubeShares(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                      const voxelize::Lattice& lattice, const std::function<void(double)>& progress) {
    CubeShares cubes;
    cubes.edge = lattice.voxel_size;
    cubes.origin[0] = cubes.origin[1] = -0.5 * cubes.edge;
    // With one voxel a layer or fewer the lattice's planes lie half a voxel off those of the layers.
    cubes.origin[2] = lattice.origin_z - (lattice.layer_height / lattice.voxel_size > 1.01 ? 0 : 0.5 * cubes.edge);

    const double wanted = kLinesPerLayer * lattice.voxel_size / lattice.layer_height * (1 - 1e-6);
    const int lines = std::max(kFewestLines, static_cast<int>(std::ceil(wanted)) | 1);
    voxelize::Lattice plan = lattice;
    plan.voxel_size = lattice.voxel_size / lines;
    plan.half_width = 1;
    const voxelize::LayerStack stack = voxelize::stackLayers(toolpath, selection);
    const voxelize::PrintColumns columns(toolpath, stack, plan, 1, voxelize::LeafColumn::Kind::values,
                                         availableMemory());
    PerThread<ColumnReader> readers(
        [&] { return ColumnReader(columns, cubes, lines, voxelize::kWeldGap * lattice.layer_height); });
    std::vector<std::vector<PartOfCube>> parts(columns.size());
    columns.forEach(
        voxelize::PrintColumns::kAllBeads,
        [&](std::size_t c, voxelize::LeafColumn& column) { readers.local().read(c, column, parts[c]); }, progress);

    std::vector<PartOfCube> all;
    for (std::vector<PartOfCube>& column : parts) {
        all.insert(all.end(), column.begin(), column.end());
        column = {};
    }
    tbb::parallel_sort(all.begin(), all.end(), before);
    join(all);
    const double full = kUnits * lines * lines;
    std::uint64_t length = 0;
    cubes.list.reserve(all.size());
    for (const PartOfCube& cube : all) {
        length += cube.length;
        cubes.list.push_back(
            {cube.i, cube.j, cube.k, static_cast<float>(static_cast<double>(cube.length) / full), cube.reached});
    }
    cubes.plastic = static_cast<double>(length) / full;
    return cubes;
}

}  // namespace stratum::mechanics
