// How far a print is from its model, and the model from the print.
#pragma once

#include "compare/best_fit.h"
#include "compare/closed_model.h"
#include "compare/rigid.h"
#include "compare/surface_samples.h"

#include <openvdb/openvdb.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stratum::compare {

/// A deviation, and where it is.
struct DeviationAt {
    double mm = 0;
    glm::dvec3 place{0.0};  ///< print space, mm
};

/// Of many places, each of the same area. Positive: the print is beyond the model; negative: material is missing.
struct Deviations {
    std::size_t samples = 0;
    double mean = 0, rms = 0;  ///< mm
    double within_95 = 0;      ///< mm: 95 % of the places deviate by no more than this
    DeviationAt least, most;
};

/// By where the model's surface looks: its normal is within 45 degrees of up, of down, or of neither.
struct DeviationsByNormal {
    Deviations all, walls, tops, bottoms;
};

struct Comparison {
    Rigid model_to_print;
    std::optional<Fit> fit;               ///< if the model was placed by it
    DeviationsByNormal print_to_model;    ///< from places on the printed surface
    DeviationsByNormal model_to_surface;  ///< from places on the model
    double model_mm3 = 0, model_mm2 = 0;
    double print_mm2 = 0;     ///< of the printed surface that a flood from outside reaches
    double hidden_share = 0;  ///< of that surface; see compareToModel()
    double print_mm3 = 0;     ///< within that surface
    /// Why it may be another model, or the same in another size or unit; sentences without a capital and a full stop.
    std::vector<std::string> doubts;
};

enum class ModelPlacement : std::uint8_t {
    fit,  ///< fitModel()
    bed,  ///< the model has the bed's coordinates already
};

struct CompareOptions {
    ModelPlacement placement = ModelPlacement::fit;
    std::size_t samples = 200'000;  ///< of each surface
    double line_width = 0.5;        ///< mm, of the print's beads: a print of the model is nearer to it
};

/// The outer surface of a print, ready for several comparisons.
class PrintedSurface {
public:
    /// `print`: see compareToModel(); must outlive it. Throws UsageError if the print has no surface.
    explicit PrintedSurface(const openvdb::FloatGrid& print);
    PrintedSurface(const PrintedSurface&) = delete;
    PrintedSurface& operator=(const PrintedSurface&) = delete;

    const openvdb::FloatGrid& grid() const { return grid_; }
    const TriangleMesh& mesh() const { return mesh_; }
    const TriangleTree& tree() const { return tree_; }
    SurfaceSamples sampled(std::size_t count) const { return sampler_(count); }
    double volume() const { return volume_; }  ///< mm^3, within it

private:
    const openvdb::FloatGrid& grid_;
    const TriangleMesh mesh_;
    const TriangleTree tree_;
    const SurfaceSampler sampler_;
    const double volume_;
};

/// compareToModel() without doubts, from a placement that is nearly right if there is one.
Comparison measureDeviations(const PrintedSurface& print, const ClosedModel& model, const CompareOptions& options,
                             const Rigid* model_to_print = nullptr);

/// Both ways. Printed parts are not airtight, and what lies below their skin is no deviation from the model: places of
/// the printed surface from which the print hides the nearest place of the model are left out.
/// `print`: the outer surface (Interior::cull) in mm, as it lies in the world. Distances are exact for the polygons of
/// both surfaces; the print's are within a tenth of a voxel of its level set. If it does not fit, other units and sizes
/// of the model and its mirror image are tried: see doubtsOf(). Parallel; the result does not depend on the number of
/// threads. Throws UsageError if the print has no surface.
Comparison compareToModel(const openvdb::FloatGrid& print, const ClosedModel& model, const CompareOptions& options);

/// What a picture of deviations shows to both sides of 0, mm: 95 % of both surfaces, rounded up to 1, 2 or 5 times a
/// power of ten.
double shownDeviation(const Comparison& comparison);

/// A grid `deviation` over the active voxels of `surface`, in mm: how far the place of the surface that is nearest to a
/// voxel is from the model. Its metadata "range" is shownDeviation(). `to_mm`: from
/// the surface's index space to that of compareToModel()'s print.
openvdb::FloatGrid::Ptr deviationGrid(const openvdb::FloatGrid& surface, const openvdb::math::Transform& to_mm,
                                      const ClosedModel& model, const Comparison& comparison);

}  // namespace stratum::compare
