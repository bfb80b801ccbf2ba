// Rays that several intersectors of one shape answer, each a piece of the way: what all ways of sharing have in common.
//
// The surfaces of two parts differ by up to half a voxel of each, so where one part hands a ray on to the next, the ray
// may be outside for the one and inside for the other. The shape is then closed by a wall between both, and a ray that
// meets the wall from outside has met the shape: nothing leaks. A ray that begins in the solid may come out through a
// wall unnoticed.
#pragma once

#include "trace/intersector.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace stratum::trace {

/// Which part answers where along one ray: piece n goes from where piece n - 1 ends to ends[n].
struct Pieces {
    /// Eight parts around each other, entered and left again.
    static constexpr std::size_t kMost = 15;
    std::array<double, kMost> ends;  ///< ascending, the last one is the ray's t_max
    std::array<std::uint8_t, kMost> parts;
    std::uint32_t count = 0;
};

/// Says who answers where. Immutable; shared by all threads.
class RayCutter {
public:
    virtual ~RayCutter() = default;
    /// At least one piece, also of a ray without a length.
    virtual void cut(const Ray& ray, Pieces& pieces) const = 0;
};

/// The nearest hit is that of the first piece that has one. Hits remember their part (Hit::part), which says what
/// attributes and normals they have. Streams are sent on to the parts as streams: all rays whose turn is the same
/// part's, together.
class PiecewiseTracer final : public Tracer {
public:
    /// The intersectors and the cutter must outlive it. No more than 256 parts.
    PiecewiseTracer(std::span<const std::shared_ptr<const Intersector>> parts, const RayCutter& cutter);

    bool intersect(const Ray& ray, Hit& hit) override;
    /// Any crossing in any piece. A ray that is stopped by nothing but walls goes through: its way in and its way out
    /// both lie within the parts' error of each other.
    bool occluded(const Ray& ray) override;
    void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) override;
    void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) override;
    glm::dvec3 shadingNormal(const Hit& hit) override;
    std::optional<glm::vec3> attribute(const Hit& hit, std::size_t which) override;

private:
    struct Way {
        Pieces pieces;
        std::uint32_t at = 0;  // the piece whose turn it is

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
    // Of the stream under way; kept, for fresh memory for every stream would cost as much as tracing it.
    std::vector<Way> ways_;
    std::vector<std::uint32_t> waiting_;  // rays without an answer, ascending
    // Of a part's turn: its rays and their numbers.
    std::vector<std::uint32_t> places_, back_places_, ahead_places_;
    std::vector<Ray> own_, back_, ahead_;
    std::vector<Hit> own_hits_, back_hits_, ahead_hits_;
    std::vector<std::uint8_t> own_blocked_;
};

}  // namespace stratum::trace
