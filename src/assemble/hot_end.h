// The hot end of a printer above its print, for pictures of a print that grows.
#pragma once

#include "assemble/traced_objects.h"
#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>

namespace stratum::assemble {

/// A print with the hot end that lays it. Immutable.
class HotEnd {
public:
    /// Adds its metals to the materials of a scene of those objects. Throws UsageError if none of them is a print.
    HotEnd(const TracedObjects& objects, shade::SceneDescription& scene);

    /// The print with the hot end at the end of its last bead at that moment, see LazyPrint.
    std::shared_ptr<const trace::Intersector> at(std::size_t moment) const;

private:
    std::shared_ptr<const trace::Intersector> print_;
    std::shared_ptr<const LazyPrint> layers_;
};

/// The print with a nozzle of brass, 7 mm across flats with a tip 1 mm wide, a block that heats it, a heat break and a
/// cold end, as solids of closed form: so slender that the print stays in sight.
/// @param print  object 0, as it is alone; its world space is print space
/// @param tip    the middle of the nozzle's tip, mm
std::shared_ptr<const trace::Intersector> withHotEnd(const std::shared_ptr<const trace::Intersector>& print,
                                                     const glm::dvec3& tip);

}  // namespace stratum::assemble
