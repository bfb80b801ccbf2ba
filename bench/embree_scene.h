// Embree's scenes: a mesh, or beads, analytic or tessellated.
#pragma once

#include "embree_queries.h"
#include "gcode/toolpath/toolpath.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace stratum::bench {

struct Corner {
    float x, y, z;
};
struct Quad {
    std::uint32_t v[4];
};
struct Triangle {
    std::uint32_t v[3];
};

/// A committed scene with its device. Safe to trace from all threads.
class EmbreeScene {
public:
    virtual ~EmbreeScene() = default;
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    virtual RTCScene handle() const = 0;
    /// What Embree says that it holds, and the primitives beside it.
    virtual std::size_t bytes() const = 0;
    virtual std::size_t primitives() const = 0;

protected:
    EmbreeScene() = default;
};

/// Throw std::runtime_error if Embree refuses.
std::unique_ptr<EmbreeScene> quadScene(std::span<const Corner> corners, std::span<const Quad> quads);
std::unique_ptr<EmbreeScene> triangleScene(std::span<const Corner> corners, std::span<const Triangle> triangles);
/// User geometry: level straight beads as plan capsules swept by a ball. Beads longer than `split` widths are cut; 0
/// leaves them whole.
std::unique_ptr<EmbreeScene> beadScene(const gcode::Toolpath& toolpath, double split);
/// Embree's own curves: round ones with the area of the bead's section, and ribbons of its width that face the ray.
std::unique_ptr<EmbreeScene> roundScene(const gcode::Toolpath& toolpath);
std::unique_ptr<EmbreeScene> ribbonScene(const gcode::Toolpath& toolpath);
/// Quads around sections of `corners` vertices on the bead's outline.
std::unique_ptr<EmbreeScene> prismScene(const gcode::Toolpath& toolpath, int corners, double split);

}  // namespace stratum::bench
