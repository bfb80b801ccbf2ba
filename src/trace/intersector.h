// The interface between geometry and shading: rays in, hits out.
//
// World space is the grid's world space (mm unless the .vdb says otherwise). Positions are double: a printer's bed is
// 10^5 voxels wide and a hit must be good to 10^-3 voxel.
#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>

namespace stratum::trace {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A ray in world space. `direction` must be of unit length; t counts world units.
struct Ray {
    glm::dvec3 origin{0.0};
    glm::dvec3 direction{0.0, 0.0, 1.0};
    double t_min = 0.0;
    double t_max = kInfinity;
};

/// An intersection of a ray with the surface, from outside or inside.
struct Hit {
    double t = 0.0;               ///< world units along the ray
    glm::dvec3 position{0.0};     ///< world space
    glm::dvec3 normal{0.0};       ///< unit, geometric: gradient of the trilinear field at the hit, towards outside
    std::uint32_t object = 0;     ///< index of the object in a scene; see scene_intersector.h
    std::uint32_t part : 31 = 0;  ///< index of the part in a composite intersector; see detail_intersector.h
    std::uint32_t cut : 1 = 0;    ///< 1: on a plane that cuts the shape; see clip_intersector.h. Of its tracers alone
};

/// Axis-aligned box in world space.
struct Box {
    glm::dvec3 min{0.0};
    glm::dvec3 max{0.0};
};

/// Traces rays in one thread. Not thread-safe: every thread makes its own from the shared Intersector, which must
/// outlive it.
class Tracer {
public:
    virtual ~Tracer() = default;
    /// The nearest hit with t in [ray.t_min, ray.t_max]. Returns false, with `hit` unchanged, if there is none.
    virtual bool intersect(const Ray& ray, Hit& hit) = 0;
    /// Whether the ray hits anything in [ray.t_min, ray.t_max].
    virtual bool occluded(const Ray& ray) = 0;

    /// The same for many rays: hits[i] is the nearest hit of rays[i], or its t is infinite. Each result depends on its
    /// own ray alone. Faster than single rays if the intersector has vector code; best with hundreds of coherent rays.
    /// `hits` is as long as `rays`.
    virtual void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) {
        for (std::size_t n = 0; n < rays.size(); ++n)
            if (!intersect(rays[n], hits[n])) hits[n].t = kInfinity;
    }
    /// blocked[i] is 1 if rays[i] hits anything, else 0. `blocked` is as long as `rays`.
    virtual void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
        for (std::size_t n = 0; n < rays.size(); ++n) blocked[n] = occluded(rays[n]) ? 1 : 0;
    }

    /// The shading normal at a hit of this tracer: unit, towards outside. The geometric one, unless the intersector was
    /// annotated with smooth normals (annotation.h).
    virtual glm::dvec3 shadingNormal(const Hit& hit) { return hit.normal; }
    /// The direction in which the material at a hit was laid, for gloss that differs along and across it: world space,
    /// near unit length, of either sign; zero where it is not known.
    virtual glm::dvec3 grain(const Hit&) { return glm::dvec3(0.0); }
    /// The value of the attribute with that number at a hit of this tracer. A number is in x, a color is linear RGB.
    /// Nothing where there is no value.
    virtual std::optional<glm::vec3> attribute(const Hit&, std::size_t) { return std::nullopt; }
};

/// A level set ready to be traced. Immutable once made; shared by all threads.
class Intersector {
public:
    virtual ~Intersector() = default;
    virtual std::unique_ptr<Tracer> makeTracer() const = 0;
    /// The method's name as in --march.
    virtual std::string_view name() const = 0;
    /// World-space box of the surface's narrow band. Unbounded shapes have infinite sides.
    virtual Box bounds() const = 0;
    /// World-space edge of a voxel, the shortest one.
    virtual double voxelSize() const = 0;
    /// Memory in addition to the grid it was made from, bytes.
    virtual std::size_t bytes() const = 0;
    /// Distance in world units by which a secondary ray's origin must be offset from a hit along the geometric normal,
    /// so that it doesn't hit the same surface again.
    virtual double surfaceOffset() const = 0;
};

}  // namespace stratum::trace
