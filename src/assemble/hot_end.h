// The hot end of a printer above its print, for pictures of a print that grows.
#pragma once

#include "shade/scene/scene.h"
#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <memory>
#include <vector>

namespace stratum::assemble {

/// A nozzle of brass, 7 mm across flats with a tip 1 mm wide, a block that heats it, a heat break and a cold end, as
/// solids of closed form: so slender that the print stays in sight. Immutable.
class HotEnd {
public:
    HotEnd();

    /// The print with the hot end, whose tip's middle is at `tip`, mm. The print is object 0, as it is alone. World
    /// space is print space.
    std::shared_ptr<const trace::Intersector> above(const std::shared_ptr<const trace::Intersector>& print,
                                                    const glm::dvec3& tip) const;

    /// Adds its materials to those of a scene whose only object is the print.
    static void addMaterials(shade::SceneDescription& scene);

private:
    std::vector<std::shared_ptr<const trace::Intersector>> parts_;  // from the tip, which is at the origin; mm
};

}  // namespace stratum::assemble
