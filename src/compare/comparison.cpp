#include "compare/comparison.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel_for.h"
#include "compare/another_model.h"
#include "compare/surface_samples.h"
#include "export/mesh/surface_mesh.h"

#include <openvdb/tools/Interpolation.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::compare {
namespace {

constexpr std::size_t kGrain = 1024;
constexpr std::size_t kFarSamples = 5'000;
constexpr std::uint32_t kPrintLeaf = 16;  // of millions of triangles, of which few are searched
const double kDiagonal = std::sqrt(0.5);  // of 45 degrees

// Points and normals in print space.
struct Place {
    glm::dvec3 at;
    double mm = 0;
    double up = 0;  // z of the model's normal there
};

TriangleMesh meshOf(const openvdb::FloatGrid& print) {
    exporter::MeshOptions options;
    options.outside_only = true;
    const exporter::SurfaceMesh surface = exporter::meshSurface(print, options);
    TriangleMesh mesh;
    mesh.points.reserve(surface.points.size());
    for (const openvdb::Vec3s& p : surface.points) mesh.points.emplace_back(p[0], p[1], p[2]);
    mesh.triangles.reserve(surface.triangleCount());
    surface.forEachTriangle([&mesh](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        mesh.triangles.push_back({a, b, c});
    });
    return mesh;
}

// mm^3: a slit between inner and outer surfaces makes it that of the plastic.
double volumeOf(const TriangleMesh& mesh) {
    double volume = 0;
    if (mesh.points.empty()) return volume;
    const glm::dvec3 origin = mesh.points.front();
    for (const Triangle& t : mesh.triangles) volume += glm::dot(mesh.corner(t, 0) - origin, mesh.areaNormal(t)) / 6;
    return volume;
}

template <typename Keep>
Deviations statisticsOf(const std::vector<Place>& places, const Keep& keep) {
    Deviations found;
    std::vector<double> sizes;
    double sum = 0;
    double squares = 0;
    for (const Place& place : places) {
        if (!keep(place)) continue;
        if (sizes.empty() || place.mm < found.least.mm) found.least = {place.mm, place.at};
        if (sizes.empty() || place.mm > found.most.mm) found.most = {place.mm, place.at};
        sum += place.mm;
        squares += place.mm * place.mm;
        sizes.push_back(std::abs(place.mm));
    }
    found.samples = sizes.size();
    if (sizes.empty()) return found;
    const auto count = static_cast<double>(sizes.size());
    found.mean = sum / count;
    found.rms = std::sqrt(squares / count);
    const auto rank = sizes.begin() + static_cast<std::ptrdiff_t>(std::ceil(0.95 * count)) - 1;
    std::nth_element(sizes.begin(), rank, sizes.end());
    found.within_95 = *rank;
    return found;
}

DeviationsByNormal byNormal(const std::vector<Place>& places) {
    DeviationsByNormal all;
    all.all = statisticsOf(places, [](const Place&) { return true; });
    all.walls = statisticsOf(places, [](const Place& place) { return std::abs(place.up) <= kDiagonal; });
    all.tops = statisticsOf(places, [](const Place& place) { return place.up > kDiagonal; });
    all.bottoms = statisticsOf(places, [](const Place& place) { return place.up < -kDiagonal; });
    return all;
}

openvdb::BBoxd boxOf(const openvdb::FloatGrid& print) {
    return print.transform().indexToWorld(print.evalActiveVoxelBoundingBox());
}

// Whether the print lies between one of its places and the outside of the model beyond: along the model's normal, from
// a voxel above the place to a voxel above the model. There is nothing outside of the print's box.
class Hidden {
public:
    Hidden(const openvdb::FloatGrid& print, const openvdb::BBoxd& box)
        : phi_(print), box_(box), voxel_(print.voxelSize()[0]) {}

    bool operator()(const glm::dvec3& at, const glm::dvec3& normal, double distance) const {
        double most = std::max(-distance, 0.0);
        for (int axis = 0; axis < 3; ++axis) {
            const double room = normal[axis] > 0 ? box_.max()[axis] - at[axis] : at[axis] - box_.min()[axis];
            // Divided only where it bounds.
            if (room < most * std::abs(normal[axis])) most = std::max(room, 0.0) / std::abs(normal[axis]);
        }
        const auto steps = static_cast<int>(std::ceil(most / (0.5 * voxel_)));
        for (int n = 0; n < steps; ++n) {
            const glm::dvec3 p = at + normal * (voxel_ * (1 + 0.5 * n));
            if (phi_.wsSample({p.x, p.y, p.z}) < 0) return true;
        }
        return false;
    }

private:
    const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> phi_;
    const openvdb::BBoxd box_;
    const double voxel_;
};

// Their samples are taken out of `samples`.
std::vector<Place> fromPrint(SurfaceSamples& samples, const openvdb::FloatGrid& print, const ClosedModel& model,
                             const Rigid& model_to_print, double rough) {
    const Rigid to_model = model_to_print.inverse();
    std::vector<Place> places(samples.points.size());
    std::vector<std::uint8_t> seen(places.size());
    const openvdb::BBoxd box = boxOf(print);
    parallelFor(places.size(), kGrain, [&](std::size_t first, std::size_t last) {
        const Hidden hidden(print, box);
        std::uint32_t hint = Nearest::kNone;
        for (std::size_t n = first; n < last; ++n) {
            const ModelDistance found = model.distance(to_model(samples.points[n]), hint, rough);
            hint = found.triangle;
            const glm::dvec3 normal = model_to_print.turn * model.normal(found.triangle);
            places[n] = {samples.points[n], found.distance, normal.z};
            seen[n] = hidden(samples.points[n], normal, found.distance) ? 0 : 1;
        }
    });
    std::size_t kept = 0;
    for (std::size_t n = 0; n < places.size(); ++n) {
        if (seen[n] == 0) continue;
        places[kept] = places[n];
        samples.points[kept] = samples.points[n];
        samples.triangles[kept++] = samples.triangles[n];
    }
    places.resize(kept);
    samples.points.resize(kept);
    samples.triangles.resize(kept);
    return places;
}

std::vector<Place> fromModel(const SurfaceSamples& samples, const ClosedModel& model, const Rigid& model_to_print,
                             const TriangleTree& surface, const openvdb::FloatGrid& print, double rough) {
    std::vector<Place> places(samples.points.size());
    const openvdb::BBoxd box = boxOf(print);
    parallelFor(places.size(), kGrain, [&](std::size_t first, std::size_t last) {
        const openvdb::tools::GridSampler<openvdb::FloatGrid, openvdb::tools::BoxSampler> phi(print);
        std::uint32_t hint = Nearest::kNone;
        for (std::size_t n = first; n < last; ++n) {
            const glm::dvec3 at = model_to_print(samples.points[n]);
            const Nearest found = surface.nearest(at, hint, rough);
            hint = found.triangle;
            const double distance = std::sqrt(found.distance2);
            // Models have places that no voxel has an index for.
            const openvdb::Vec3d p(at.x, at.y, at.z);
            const bool inside = box.isInside(p) && phi.wsSample(p) < 0;
            places[n] = {at, inside ? distance : -distance,
                         (model_to_print.turn * model.normal(samples.triangles[n])).z};
        }
    });
    return places;
}

// The gradient of the level set by differences to the neighbours that are nearer to the surface: values beyond the band
// are clamped, and say nothing (Rouy and Tourin, SIAM Journal on Numerical Analysis 29, 1992).
template <typename Accessor>
glm::dvec3 slopeTowardsSurface(const Accessor& phi, const openvdb::Coord& at, double voxel) {
    const auto here = static_cast<double>(phi.getValue(at));
    glm::dvec3 slope(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Coord step(0);
        step[axis] = 1;
        const double back = here - static_cast<double>(phi.getValue(at - step));
        const double ahead = static_cast<double>(phi.getValue(at + step)) - here;
        const double side = here < 0 ? -1 : 1;
        if (side * back > 0 && side * back >= -side * ahead)
            slope[axis] = back / voxel;
        else if (side * ahead < 0)
            slope[axis] = ahead / voxel;
    }
    return slope;
}

}  // namespace

PrintedSurface::PrintedSurface(const openvdb::FloatGrid& print)
    : grid_(print), mesh_(meshOf(print)), tree_(mesh_, kPrintLeaf), sampler_(mesh_), volume_(volumeOf(mesh_)) {
    if (mesh_.triangles.empty())
        throw UsageError("--compare: the print has no surface at this voxel size; choose a smaller --voxel-size");
}

Comparison measureDeviations(const PrintedSurface& print, const ClosedModel& model, const CompareOptions& options,
                             const Rigid* model_to_print) {
    SurfaceSamples printed = print.sampled(options.samples);
    Comparison comparison;
    comparison.model_mm3 = model.volume();
    comparison.model_mm2 = model.area();
    comparison.print_mm2 = printed.area;
    comparison.print_mm3 = print.volume();
    const bool fits = options.placement == ModelPlacement::fit;
    if (fits) {
        comparison.fit =
            model_to_print != nullptr ? refineFit(model, printed, *model_to_print) : fitModel(model, printed);
        comparison.model_to_print = comparison.fit->model_to_print;
    }
    const double residual = fits ? comparison.fit->residual : roughResidual(model, printed, comparison.model_to_print);
    // Far places take long to measure, and of a model that does not fit fewer tell as much, and their distances to a
    // hundredth.
    const bool far = residual > options.line_width;
    const double rough = far ? options.line_width : std::numeric_limits<double>::infinity();
    const std::size_t samples =
        affordable(model, printed, far ? std::min(options.samples, kFarSamples) : options.samples);
    printed = thinned(printed, samples);
    const auto all = static_cast<double>(printed.points.size());
    std::vector<Place> places = fromPrint(printed, print.grid(), model, comparison.model_to_print, rough);
    comparison.hidden_share = 1 - static_cast<double>(places.size()) / all;
    if (fits && comparison.fit->converged && printed.points.size() >= kFewestSamples) {
        comparison.fit = refineFit(model, printed, comparison.model_to_print);
        comparison.model_to_print = comparison.fit->model_to_print;
        places = fromPrint(printed, print.grid(), model, comparison.model_to_print, rough);
    }
    comparison.print_to_model = byNormal(places);
    comparison.model_to_surface = byNormal(fromModel(sampleSurface(model.mesh(), samples), model,
                                                     comparison.model_to_print, print.tree(), print.grid(), rough));
    return comparison;
}

Comparison compareToModel(const openvdb::FloatGrid& print, const ClosedModel& model, const CompareOptions& options) {
    const PrintedSurface surface(print);
    Comparison comparison = measureDeviations(surface, model, options);
    comparison.doubts = doubtsOf(surface, model, comparison, options);
    return comparison;
}

double shownDeviation(const Comparison& comparison) {
    const double least =
        std::max({comparison.print_to_model.all.within_95, comparison.model_to_surface.all.within_95, 1e-6});
    const double ten = std::pow(10, std::floor(std::log10(least)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * ten >= least) return step * ten;
    return 10 * ten;
}

openvdb::FloatGrid::Ptr deviationGrid(const openvdb::FloatGrid& surface, const openvdb::math::Transform& to_mm,
                                      const ClosedModel& model, const Comparison& comparison) {
    requireMemory(static_cast<double>(surface.memUsage()), "a grid of deviations", "choose a larger voxel");
    using Leaf = openvdb::FloatTree::LeafNodeType;
    auto grid =
        openvdb::FloatGrid::create(std::make_shared<openvdb::FloatTree>(surface.tree(), 0.0F, openvdb::TopologyCopy()));
    grid->setTransform(surface.transform().copy());
    grid->setName("deviation");
    const double shown = shownDeviation(comparison);
    grid->insertMeta("range", openvdb::Vec2DMetadata(openvdb::Vec2d(-shown, shown)));
    std::vector<Leaf*> leaves;
    grid->tree().getNodes(leaves);
    const Rigid to_model = comparison.model_to_print.inverse();
    const double voxel = surface.voxelSize()[0];
    // The slope has no unit. It is along the axes of the index space, which those of a print on a belt lean to.
    glm::dmat3 turn;
    for (int axis = 0; axis < 3; ++axis) {
        openvdb::Vec3d edge(0.0);
        edge[axis] = 1;
        edge = to_mm.baseMap()->applyJacobian(edge) / to_mm.voxelSize()[axis];
        turn[axis] = {edge[0], edge[1], edge[2]};
    }
    const double mm = to_mm.voxelSize()[0] / voxel;
    parallelFor(leaves.size(), 16, [&](std::size_t first, std::size_t last) {
        auto phi = surface.getConstAccessor();
        std::uint32_t hint = Nearest::kNone;
        for (std::size_t n = first; n < last; ++n)
            for (auto value = leaves[n]->beginValueOn(); value; ++value) {
                const openvdb::Coord at = value.getCoord();
                const glm::dvec3 slope = slopeTowardsSurface(phi, at, voxel);
                const openvdb::Vec3d world = to_mm.indexToWorld(at);
                glm::dvec3 place(world[0], world[1], world[2]);
                // One step of Newton's to the surface; between beads the slope vanishes, and the voxel stays.
                const double steep = glm::dot(slope, slope);
                if (steep > 0.25) place -= turn * slope * (mm * static_cast<double>(phi.getValue(at)) / steep);
                const ModelDistance found = model.distance(to_model(place), hint);
                hint = found.triangle;
                value.setValue(static_cast<float>(found.distance));
            }
    });
    return grid;
}

}  // namespace stratum::compare
