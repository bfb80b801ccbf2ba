#include "report/walls/roughness.h"

#include "base/parallel_for.h"
#include "report/walls/bead_middle.h"
#include "report/walls/fine_field.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace stratum::report {
namespace {

constexpr int kLengths = 5;            // sampling lengths of a line
constexpr int kPointsOfLayer = 64;     // of the profile
constexpr int kVoxelsOfLayer = 32;     // at least
constexpr double kLeastHeight = 0.01;  // mm; finer voxels could not be indexed on a large bed

// The profile of a wall: where the surface is along a horizontal direction, height by height.
class Profile {
public:
    Profile(FineField& field, const Point& origin, double nx, double ny, double voxel, double most)
        : field_(field), origin_(origin), nx_(nx), ny_(ny), voxel_(voxel), most_(most) {}

    // mm along the direction; from the place found before, or from `at_`.
    std::optional<double> at(double z) {
        const double start = at_;
        double value = valueAt(start, z);
        // Inside it goes out, outside it goes in.
        const double step = value < 0 ? 0.25 * voxel_ : -0.25 * voxel_;
        double from = start;
        while (std::abs(from - start) <= most_) {
            const double to = from + step;
            const double next = valueAt(to, z);
            if ((next < 0) != (value < 0)) {
                at_ = crossing(from, to, z, value < 0);
                return at_;
            }
            from = to;
            value = next;
        }
        return std::nullopt;
    }
    void beginAt(double across) { at_ = across; }

private:
    double valueAt(double across, double z) const {
        return field_.value({origin_.x + across * nx_, origin_.y + across * ny_, z});
    }
    double crossing(double a, double b, double z, bool a_inside) const {
        for (int n = 0; n < 24; ++n) {
            const double middle = 0.5 * (a + b);
            ((valueAt(middle, z) < 0) == a_inside ? a : b) = middle;
        }
        return 0.5 * (a + b);
    }

    FineField& field_;
    const Point origin_;
    const double nx_, ny_, voxel_, most_;
    double at_ = 0;
};

struct Roughness {
    double ra, rz;
};

// Of values at equal steps, about their least squares line.
Roughness roughnessOf(std::span<const double> profile) {
    const auto count = static_cast<double>(profile.size());
    const double middle = 0.5 * (count - 1);
    double mean = 0;
    double moment = 0;
    for (std::size_t n = 0; n < profile.size(); ++n) {
        mean += profile[n] / count;
        moment += profile[n] * (static_cast<double>(n) - middle);
    }
    const double slope = moment / (count * (count * count - 1) / 12);
    double sum = 0;
    double low = 0;
    double high = 0;
    for (std::size_t n = 0; n < profile.size(); ++n) {
        const double off = profile[n] - mean - slope * (static_cast<double>(n) - middle);
        sum += std::abs(off);
        low = std::min(low, off);
        high = std::max(high, off);
    }
    return {sum / count, high - low};
}

// With planes where those of `lattice` are.
voxelize::Lattice finerLattice(voxelize::Lattice lattice, double height) {
    lattice.voxel_size /= std::max(1.0, std::ceil(kVoxelsOfLayer * lattice.voxel_size / height - 1e-6));
    lattice.half_width = 2;  // points lie between samples
    return lattice;
}

std::optional<RoughnessLine> measureLine(const FieldProbe& probe, const gcode::Toolpath& toolpath,
                                         const voxelize::LayerStack& stack, const gcode::Bead& bead,
                                         const voxelize::Lattice& lattice) {
    const BeadMiddle middle = middleOf(toolpath, bead);
    const double height = static_cast<double>(toolpath.runOf(bead).height);
    if ((middle.nx == 0 && middle.ny == 0) || !(height >= kLeastHeight)) return std::nullopt;
    const double side = 0.5 * static_cast<double>(bead.width);
    const double beside = side + lattice.voxel_size;
    double sign = 0;
    for (const double way : {1.0, -1.0}) {
        const Point p{middle.at.x + way * beside * middle.nx, middle.at.y + way * beside * middle.ny, middle.at.z};
        if (sign == 0 && probe.isOutside(p)) sign = way;
    }
    if (sign == 0) return std::nullopt;
    const double length = samplingLength(height);
    const double bottom = middle.at.z - 0.5 * height;
    const voxelize::Lattice fine = finerLattice(lattice, height);
    // A wall that leans by more than 76 degrees leaves the part that is measured: then the line is shorter.
    const double highest = kLengths * length;
    FineField field(toolpath, stack, fine,
                    {middle.at.x, middle.at.y, 4 * highest + 2 * side, bottom, bottom + highest});
    Profile profile(field, middle.at, sign * middle.nx, sign * middle.ny, fine.voxel_size, 2 * side);
    const auto layers = static_cast<std::size_t>(std::lround(length / height));
    const std::size_t points = layers * kPointsOfLayer;
    const double step = height / kPointsOfLayer;
    // On the planes between layers too, where the grooves are deepest. Begins at half the bead's height, where the
    // surface is sure to be, and goes down to its bottom first.
    profile.beginAt(side);
    if (!profile.at(middle.at.z)) return std::nullopt;
    for (int n = kPointsOfLayer / 2; n >= 0; --n)
        if (!profile.at(bottom + n * step)) return std::nullopt;
    RoughnessLine line;
    line.at = {middle.at.x, middle.at.y, bottom};
    int lengths = 0;
    std::vector<double> values;
    values.reserve(points);
    for (; lengths < kLengths; ++lengths) {
        values.clear();
        for (std::size_t n = 0; n < points; ++n) {
            const auto at = profile.at(
                bottom + (static_cast<double>(lengths) * static_cast<double>(points) + static_cast<double>(n)) * step);
            if (!at) break;
            values.push_back(*at);
        }
        if (values.size() < points) break;
        const Roughness roughness = roughnessOf(values);
        line.ra += roughness.ra;
        line.rz += roughness.rz;
    }
    if (lengths == 0) return std::nullopt;
    line.ra /= lengths;
    line.rz /= lengths;
    line.length = lengths * static_cast<double>(layers) * height;
    return line;
}

bool isOuter(gcode::Feature feature) {
    return feature == gcode::Feature::external_perimeter || feature == gcode::Feature::overhang_perimeter;
}

// Beads at even distances along the outer perimeters.
std::vector<std::uint32_t> placesOf(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    const auto featureOf = [&](std::uint32_t bead) { return toolpath.runOf(toolpath.beads[bead]).feature; };
    const bool labelled =
        std::any_of(selection.begin(), selection.end(), [&](std::uint32_t bead) { return isOuter(featureOf(bead)); });
    const auto counts = [&](std::uint32_t bead) { return !labelled || isOuter(featureOf(bead)); };
    double total = 0;
    for (const std::uint32_t bead : selection)
        if (counts(bead)) total += gcode::beadLength(toolpath, toolpath.beads[bead]);
    std::vector<std::uint32_t> places;
    double along = 0;
    for (const std::uint32_t bead : selection) {
        if (!counts(bead)) continue;
        along += gcode::beadLength(toolpath, toolpath.beads[bead]);
        if (along * kRoughnessLines >= (static_cast<double>(places.size()) + 0.5) * total) places.push_back(bead);
    }
    return places;
}

}  // namespace

double samplingLength(double layer_height) {
    const double period = layer_height - 1e-6;  // heights were floats
    const double standard = period <= 0.13 ? 0.25 : period <= 0.4 ? 0.8 : period <= 1.3 ? 2.5 : 8;
    return std::max(1.0, std::round(standard / layer_height)) * layer_height;
}

std::vector<RoughnessLine> measureRoughness(const openvdb::FloatGrid& grid, const gcode::Toolpath& toolpath,
                                            const voxelize::LayerStack& stack, std::span<const std::uint32_t> selection,
                                            const voxelize::Lattice& lattice, const LeafMap& map,
                                            const Outside* outside) {
    const std::vector<std::uint32_t> places = placesOf(toolpath, selection);
    std::vector<std::optional<RoughnessLine>> tried(places.size());
    parallelFor(places.size(), 1, [&](std::size_t begin, std::size_t end) {
        const FieldProbe probe(grid, lattice, map, outside);
        for (std::size_t n = begin; n != end; ++n)
            tried[n] = measureLine(probe, toolpath, stack, toolpath.beads[places[n]], lattice);
    });
    std::vector<RoughnessLine> lines;
    for (const std::optional<RoughnessLine>& line : tried)
        if (line) lines.push_back(*line);
    return lines;
}

}  // namespace stratum::report
