// The hot end of a printer above its print, for pictures of a print that grows.
#pragma once

#include "assemble/traced_objects.h"
#include "base/names.h"
#include "shade/camera/camera.h"
#include "shade/film/film.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <string_view>
#include <vector>

namespace stratum::assemble {

// The solids that a hot end is drawn with.

enum class HotEndShape {
    slender,  ///< no printer's: 27 mm high and 15 mm wide, so that a print stays in sight
    v6,       ///< E3D V6: 62.3 mm high
    volcano,  ///< E3D V6 with a Volcano block and nozzle: 70.8 mm high
};
inline constexpr Names<HotEndShape, 3> kHotEndShapes = {
    {{"slender", HotEndShape::slender}, {"v6", HotEndShape::v6}, {"volcano", HotEndShape::volcano}}};

/// A solid of closed form.
struct HotEndPart {
    std::shared_ptr<const trace::Intersector> solid;  ///< mm, from the middle of the nozzle's tip
    std::string_view metal;                           ///< for shade::makeBrdf()
};

/// From the tip upwards. Lengths of V6 and Volcano: from public models of the maker's drawings (wiki.e3d-online.com,
/// "E3D-v6 Documentation" and "E3D-v6 (Volcano) Documentation"), not from the drawings themselves; holes, threads,
/// wires and the fan are left out, and the cone of the heat sink's core is a cylinder of its mean diameter.
std::vector<HotEndPart> makeHotEndParts(HotEndShape shape);

enum class HotEndKind {
    none,
    metal,  ///< solid, with shadow and reflection
    clear,  ///< drawn over the picture as thin glass, so that the part shows through; no shadow
};
inline constexpr Names<HotEndKind, 3> kHotEnds = {
    {{"none", HotEndKind::none}, {"metal", HotEndKind::metal}, {"clear", HotEndKind::clear}}};

/// What is drawn, and how.
struct HotEndLook {
    HotEndKind kind = HotEndKind::none;
    HotEndShape shape = HotEndShape::slender;
};

/// A print with the hot end that lays it. A slender one is 27 mm high, and less where the part is smaller than 40 mm:
/// it has two thirds of its larger side, but a quarter of its size at least. Others have their own size. Immutable.
class HotEnd {
public:
    /// Adds the metals of a solid one to the materials of a scene of those objects. Throws UsageError if none of them
    /// is a print.
    HotEnd(const TracedObjects& objects, shade::SceneDescription& scene, const HotEndLook& look);

    /// What is traced at that moment, see LazyPrint: the print, with a solid hot end at the end of its last bead.
    std::shared_ptr<const trace::Intersector> at(std::size_t moment) const;
    /// The print as it is without.
    const std::shared_ptr<const trace::Intersector>& alone() const { return print_; }

    /// Draws a clear hot end into a finished picture of that moment: what of it is before the print covers a third of
    /// a pixel, more of it towards its silhouette. Of a solid one nothing.
    /// @param white  the film's value of a white surface
    void drawOver(std::size_t moment, const shade::Camera& camera, double white, shade::Film& film) const;

private:
    std::shared_ptr<const trace::Intersector> print_;
    std::shared_ptr<const LazyPrint> layers_;
    HotEndKind kind_;
    std::vector<HotEndPart> parts_;
    double scale_ = 1.0;
    double tilt_ = 0.0;
};

/// The print with a hot end, `scale` times the size of its parts.
/// @param print  object 0, as it is alone; its world space is in mm
/// @param tip    the middle of the nozzle's tip, mm
/// @param parts  objects 1 and on
/// @param tilt   degrees about x that it leans by: gcode::Toolpath::belt_angle
std::shared_ptr<const trace::Intersector> withHotEnd(const std::shared_ptr<const trace::Intersector>& print,
                                                     const glm::dvec3& tip, const std::vector<HotEndPart>& parts,
                                                     double scale = 1.0, double tilt = 0.0);

}  // namespace stratum::assemble
