// Rays that are traced by several intersectors of one shape, each along one piece of the ray.
//
// The surfaces of two parts differ by up to half a voxel of each, so at the boundary between two pieces a ray may be
// outside of one part and inside of the other. The shape is then closed by a wall on the boundary, and a ray that meets
// the wall from outside has hit the shape: nothing leaks. A ray that begins in the solid may leave through a wall
// undetected.
#pragma once

#include "trace/intersector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace stratum::trace {

/// The pieces of one ray and their parts: piece n goes from the end of piece n - 1 to ends[n].
struct Pieces {
    /// Enough for eight nested parts, each entered and left.
    static constexpr std::size_t kMost = 15;
    std::array<double, kMost> ends;  ///< ascending, the last one is the ray's t_max
    std::array<std::uint8_t, kMost> parts;
    std::uint32_t count = 0;
};

/// Cuts rays into pieces. Immutable; shared by all threads.
class RayCutter {
public:
    virtual ~RayCutter() = default;
    /// At least one piece, even for a ray without a length.
    virtual void cut(const Ray& ray, Pieces& pieces) const = 0;
};

/// The nearest hit is that of the first piece that has one. Hit::part is the part, which has the attributes and normals
/// of the hit. Streams are passed on to the parts as streams: all rays whose current piece has the same part, together.
class PiecewiseTracer final : public Tracer {
public:
    /// The intersectors and the cutter must outlive it. No more than 256 parts.
    PiecewiseTracer(std::span<const std::shared_ptr<const Intersector>> parts, const RayCutter& cutter);

    bool intersect(const Ray& ray, Hit& hit) override;
    /// Any crossing in any piece. Walls don't occlude: the entry and the exit of a ray that meets nothing but walls are
    /// within the parts' error of each other.
    bool occluded(const Ray& ray) override;
    void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) override;
    void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) override;
    glm::dvec3 shadingNormal(const Hit& hit) override;
    glm::dvec3 grain(const Hit& hit) override;
    std::optional<glm::vec3> attribute(const Hit& hit, std::size_t which) override;

private:
    struct Way {
        Pieces pieces;
        std::uint32_t at = 0;  // the current piece

        std::uint8_t part() const { return pieces.parts[at]; }
        /// Not of the first piece.
        std::uint8_t before() const { return pieces.parts[at - 1]; }
        bool last() const { return at + 1 == pieces.count; }
        double begin(const Ray& ray) const { return at == 0 ? ray.t_min : pieces.ends[at - 1]; }
        Ray piece(const Ray& ray) const;
    };
    bool wantsLookBack(const Ray& ray, const Way& way, const Hit* found) const;
    void cutAll(std::span<const Ray> rays);
    void gather(std::size_t part, std::span<const Ray> rays);
    void lookBack(std::size_t part, std::span<const Ray> rays);
    void goOn();
    Hit marked(Hit hit, std::size_t part) const;
    Hit own(const Hit& hit) const;

    std::vector<std::unique_ptr<Tracer>> tracers_;
    const RayCutter& cutter_;
    // The current stream; members, because allocating them for every stream would cost as much as tracing it.
    std::vector<Way> ways_;
    std::vector<std::uint32_t> waiting_;  // rays without a result, ascending
    // The rays of the current part, and their indices.
    std::vector<std::uint32_t> places_, back_places_, ahead_places_;
    std::vector<Ray> own_, back_, ahead_;
    std::vector<Hit> own_hits_, back_hits_, ahead_hits_;
    std::vector<std::uint8_t> own_blocked_;
};

}  // namespace stratum::trace
