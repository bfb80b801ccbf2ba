#include "voxelize/beads/lattice.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel_for.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

namespace stratum::voxelize {
namespace {

// Without a request: the finest within these bounds for which the part's box has at most this many samples. Three
// voxels a layer show layer lines well; with two they begin to look cut.
constexpr int kFinestVoxelsPerLayer = 4;
constexpr int kCoarsestVoxelsPerLayer = 2;
// For pictures whose voxels would be longer.
constexpr double kPixelsPerVoxel = 2;
constexpr int kFinestForPixels = 8;
constexpr double kComfortableActiveVoxels = 60e6;
// Share of the available memory for the estimate of a grid of default size. The estimate can be off by a factor of two
// or three.
constexpr double kComfortableShare = 0.5;

// A plane within this fraction of a voxel of a voxel plane is on it.
constexpr double kOnPlane = 0.01;

// Layers of 0.15625 mm exist; less than ten nanometres is rounding.
constexpr double kGrainsPerMm = 1e5;
std::int64_t grains(double mm) { return std::llround(mm * kGrainsPerMm); }

// Of the beads of a selection, in its order, mm.
std::vector<double> lengthsOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    constexpr std::size_t kGrain = 8192;
    std::vector<double> lengths(selection.size());
    parallelFor(selection.size(), kGrain, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n != last; ++n)
            lengths[n] = gcode::beadLength(toolpath, toolpath.beads[selection[n]]);
    });
    return lengths;
}

// Printed length by a measure in whole grains.
class Histogram {
public:
    void add(double mm, double length) {
        // Neighbours in print order nearly always agree.
        if (mm != last_) {
            sum_ = &sums_[grains(mm)];
            last_ = mm;
        }
        *sum_ += length;
    }
    bool empty() const { return sums_.empty(); }
    /// The measure of which most is printed.
    std::int64_t longest() const {
        return std::max_element(sums_.begin(), sums_.end(),
                                [](const auto& a, const auto& b) { return a.second < b.second; })
            ->first;
    }

private:
    std::map<std::int64_t, double> sums_;
    double last_ = std::numeric_limits<double>::quiet_NaN();
    double* sum_ = nullptr;
};

// The number of voxels a layer for a print whose user named none.
void chooseByItself(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                    const LatticeRequest& request, Lattice& lattice) {
    const auto memory = static_cast<double>(request.memory != 0 ? request.memory : availableMemory());
    const auto voxelsAt = [&](int count) {
        return estimateActiveVoxels(toolpath, selection, lattice.layer_height / count, request.half_width);
    };
    const double bytes_per_voxel = kBytesPerActiveVoxel * (request.bytes_per_leaf / kBytesPerLeaf);
    const double affordable = kComfortableShare * memory / bytes_per_voxel;
    int count = kFinestVoxelsPerLayer;
    bool short_of_memory = false;
    while (count > kCoarsestVoxelsPerLayer && voxelsAt(count) > std::min(kComfortableActiveVoxels, affordable)) {
        short_of_memory = voxelsAt(count) <= kComfortableActiveVoxels;
        --count;
    }
    // Pictures: bricks are made where rays come to, so finer voxels cost little.
    const bool facets = count == kFinestVoxelsPerLayer && request.pixel > 0 &&
                        lattice.layer_height / count > kPixelsPerVoxel * request.pixel;
    if (facets) {
        const double least = std::ceil(lattice.layer_height / (kPixelsPerVoxel * request.pixel));
        count = static_cast<int>(std::min<double>(least, kFinestForPixels));
    }
    lattice.voxel_size = lattice.layer_height / count;
    lattice.reason = fmt::format("chosen: {} voxels a layer of {:g} mm", count, lattice.layer_height);
    if (facets) lattice.reason += fmt::format("; a pixel spans {:.3g} mm", request.pixel);
    if (short_of_memory)
        lattice.reason += fmt::format("; {} would take about {:.2g} GB of the {:.2g} GB that are free", count + 1,
                                      voxelsAt(count + 1) * bytes_per_voxel * 1e-9, memory * 1e-9);
}

// Voxels larger than the part, and more voxels than an index can count.
void refuseUnfit(const Lattice& lattice, const Bounds& bounds) {
    const double extent = std::max({bounds.extent(0), bounds.extent(1), bounds.extent(2)});
    if (lattice.voxel_size > extent)
        throw UsageError(
            fmt::format("voxel size {:g} mm is larger than the part ({:.3f} x {:.3f} x {:.3f} mm); the "
                        "layer height is {:g} mm, try {:g}",
                        lattice.voxel_size, bounds.extent(0), bounds.extent(1), bounds.extent(2), lattice.layer_height,
                        lattice.layer_height / 2));
    // OpenVDB indexes with 32-bit integers; a factor of four is reserved for the band and for other tools.
    double farthest = 0;
    for (int axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::abs(bounds.min[axis]), std::abs(bounds.max[axis])});
    if (farthest / lattice.voxel_size > 536870912.0)
        throw UsageError(
            fmt::format("voxel size {:g} mm: {:.3g} voxels from the origin to the part's far end, more "
                        "than OpenVDB can index; try {:g} mm",
                        lattice.voxel_size, farthest / lattice.voxel_size, lattice.layer_height / 2));
}

// The part of the level beads' length whose planes are planes of samples.
double alignedShare(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                    std::span<const double> lengths, const Lattice& lattice) {
    const auto on_plane = [&](double z) {
        const double k = (z - lattice.origin_z) / lattice.voxel_size;
        return std::abs(k - std::round(k)) <= kOnPlane;
    };
    double level = 0;
    double aligned = 0;
    std::pair<double, double> last{std::numeric_limits<double>::quiet_NaN(), 0};  // z, height
    bool last_aligned = false;
    for (std::size_t n = 0; n < selection.size(); ++n) {
        const gcode::Bead& bead = toolpath.beads[selection[n]];
        if (bead.z0 != bead.z1) continue;
        const std::pair<double, double> planes{bead.z0, toolpath.runOf(bead).height};
        if (planes != last) {
            last_aligned = on_plane(planes.first) && on_plane(planes.first - planes.second);
            last = planes;
        }
        level += lengths[n];
        if (last_aligned) aligned += lengths[n];
    }
    return level > 0 ? aligned / level : 0;
}

}  // namespace

Lattice chooseLattice(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Bounds& bounds,
                      const LatticeRequest& request) {
    if (!(request.half_width >= 1 && request.half_width <= 10))
        throw UsageError(
            fmt::format("half-width of {} voxels: expected 1 to 10 (3 suits OpenVDB's tools)", request.half_width));

    // Printed length by layer height, and by bottom plane within the majority height.
    const std::vector<double> lengths = lengthsOf(toolpath, selection);
    Histogram by_height;
    for (std::size_t n = 0; n < selection.size(); ++n)
        by_height.add(toolpath.runOf(toolpath.beads[selection[n]]).height, lengths[n]);
    const std::int64_t usual_height = by_height.longest();
    Histogram by_plane;
    double last_height = std::numeric_limits<double>::quiet_NaN();
    bool of_most = false;  // of the height of which most is printed
    for (std::size_t n = 0; n < selection.size(); ++n) {
        const gcode::Bead& bead = toolpath.beads[selection[n]];
        const double height = toolpath.runOf(bead).height;
        if (height != last_height) {
            of_most = grains(height) == usual_height;
            last_height = height;
        }
        if (of_most && bead.z0 == bead.z1) by_plane.add(bead.z0 - height, lengths[n]);
    }

    Lattice lattice;
    lattice.half_width = request.half_width;
    lattice.layer_height = static_cast<double>(usual_height) / kGrainsPerMm;
    if (request.voxel_size) {
        lattice.voxel_size = *request.voxel_size;
        lattice.reason = "as asked";
        if (!(std::isfinite(lattice.voxel_size) && lattice.voxel_size > 0))
            throw UsageError(fmt::format("voxel size {} mm: expected a number above 0, e.g. 0.1", lattice.voxel_size));
    } else if (request.voxels_per_layer) {
        if (*request.voxels_per_layer < 1 || *request.voxels_per_layer > 64)
            throw UsageError(fmt::format("{} voxels a layer: expected 1 to 64", *request.voxels_per_layer));
        lattice.voxel_size = lattice.layer_height / *request.voxels_per_layer;
        lattice.reason = fmt::format("{} voxels a layer of {:g} mm", *request.voxels_per_layer, lattice.layer_height);
    } else {
        chooseByItself(toolpath, selection, request, lattice);
    }
    refuseUnfit(lattice, bounds);
    if (!by_plane.empty()) {
        const double plane = static_cast<double>(by_plane.longest()) / kGrainsPerMm;
        lattice.origin_z = plane - std::floor(plane / lattice.voxel_size + kOnPlane) * lattice.voxel_size;
        // See the head of lattice.h.
        if (lattice.voxel_size > (1 - kOnPlane) * lattice.layer_height) {
            lattice.origin_z +=
                lattice.origin_z < 0.5 * lattice.voxel_size ? 0.5 * lattice.voxel_size : -0.5 * lattice.voxel_size;
            lattice.reason += ", its planes half a voxel off those of the layers";
        }
        if (std::abs(lattice.origin_z) < 1e-9) lattice.origin_z = 0;
    }

    lattice.aligned_share = alignedShare(toolpath, selection, lengths, lattice);
    return lattice;
}

}  // namespace stratum::voxelize
