#include "trace/clip_intersector.h"

#include "base/error.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::trace {
namespace {

/// The part of a ray before all planes.
struct Clipped {
    Ray ray;                 ///< from there on; its t_max stays
    double end = kInfinity;  ///< where it leaves
    int entry = -1;          ///< the plane that it enters through; -1 if it starts before all
    int exit = -1;           ///< the plane that it leaves through; -1 if it doesn't
    bool empty = false;
};

Clipped clipped(const std::vector<ClipPlane>& planes, const Ray& ray) {
    Clipped part{ray, kInfinity, -1, -1, false};
    for (std::size_t n = 0; n < planes.size(); ++n) {
        const double slope = glm::dot(planes[n].normal, ray.direction);
        const double over = glm::dot(planes[n].normal, ray.origin) - planes[n].offset;
        if (slope == 0.0) {
            if (over > 0.0) part.empty = true;
            continue;
        }
        const double t = -over / slope;
        if (slope > 0.0) {
            if (t < part.end) {
                part.end = t;
                part.exit = static_cast<int>(n);
            }
        } else if (t > part.ray.t_min) {
            part.ray.t_min = t;
            part.entry = static_cast<int>(n);
        }
    }
    part.empty = part.empty || !(part.ray.t_min < part.end) || part.ray.t_min > ray.t_max;
    return part;
}

/// Whether the ray may meet a cut. Then it is followed to the shape's next surface, however far: if it meets that from
/// inside, it is inside of the shape on the way there, and so at the planes that it crossed before.
bool meetsPlane(const Clipped& part) { return part.entry >= 0 || part.end <= part.ray.t_max; }

Ray sightOf(const Clipped& part) {
    Ray ray = part.ray;
    if (meetsPlane(part)) ray.t_max = kInfinity;
    return ray;
}

class ClipTracer final : public Tracer {
public:
    ClipTracer(const Intersector& shape, const std::vector<ClipPlane>& planes)
        : tracer_(shape.makeTracer()), planes_(planes) {}

    bool intersect(const Ray& ray, Hit& hit) override {
        const Clipped part = clipped(planes_, ray);
        Hit found;
        return !part.empty && tracer_->intersect(sightOf(part), found) && accept(part, found, hit);
    }

    bool occluded(const Ray& ray) override {
        const Clipped part = clipped(planes_, ray);
        if (part.empty) return false;
        if (!meetsPlane(part)) return tracer_->occluded(part.ray);
        Hit found;
        Hit ignored;
        return tracer_->intersect(sightOf(part), found) && accept(part, found, ignored);
    }

    void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) override {
        gather(rays, [](const Clipped&) { return true; });
        tracer_->intersectStream(rays_, found_);
        for (Hit& hit : hits) hit.t = kInfinity;
        for (std::size_t n = 0; n < places_.size(); ++n)
            if (std::isfinite(found_[n].t)) (void)accept(parts_[n], found_[n], hits[places_[n]]);
    }

    void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) override {
        std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
        gather(rays, [](const Clipped& part) { return !meetsPlane(part); });
        blocked_.resize(rays_.size());
        tracer_->occludedStream(rays_, blocked_);
        for (std::size_t n = 0; n < places_.size(); ++n) blocked[places_[n]] = blocked_[n];
        // These need to know from which side they meet the shape.
        gather(rays, meetsPlane);
        tracer_->intersectStream(rays_, found_);
        Hit ignored;
        for (std::size_t n = 0; n < places_.size(); ++n)
            if (std::isfinite(found_[n].t) && accept(parts_[n], found_[n], ignored)) blocked[places_[n]] = 1;
    }

    glm::dvec3 shadingNormal(const Hit& hit) override {
        return hit.cut != 0 ? hit.normal : tracer_->shadingNormal(hit);
    }
    glm::dvec3 grain(const Hit& hit) override {
        // A cut was not drawn by a nozzle.
        return hit.cut != 0 ? glm::dvec3(0.0) : tracer_->grain(hit);
    }
    std::optional<glm::vec3> attribute(const Hit& hit, std::size_t which) override {
        return tracer_->attribute(hit, which);
    }

private:
    bool accept(const Clipped& part, const Hit& found, Hit& hit) const {
        const bool from_inside = glm::dot(found.normal, part.ray.direction) > 0.0;
        if (from_inside && part.entry >= 0) {
            hit = cutAt(part, part.ray.t_min, part.entry, found);
            return true;
        }
        if (found.t <= std::min(part.end, part.ray.t_max)) {
            hit = found;
            hit.cut = 0;
            return true;
        }
        if (!from_inside || part.end > part.ray.t_max) return false;
        hit = cutAt(part, part.end, part.exit, found);
        return true;
    }

    Hit cutAt(const Clipped& part, double t, int plane, const Hit& found) const {
        Hit hit = found;
        hit.t = t;
        hit.position = part.ray.origin + t * part.ray.direction;
        hit.normal = planes_[static_cast<std::size_t>(plane)].normal;
        hit.cut = 1;
        return hit;
    }

    /// The rays that have a part before the planes which is asked for.
    template <typename Wanted>
    void gather(std::span<const Ray> rays, const Wanted& wanted) {
        rays_.clear();
        parts_.clear();
        places_.clear();
        for (std::size_t n = 0; n < rays.size(); ++n) {
            const Clipped part = clipped(planes_, rays[n]);
            if (part.empty || !wanted(part)) continue;
            rays_.push_back(sightOf(part));
            parts_.push_back(part);
            places_.push_back(n);
        }
        found_.resize(rays_.size());
    }

    const std::unique_ptr<Tracer> tracer_;
    const std::vector<ClipPlane>& planes_;
    // The current stream; members, because allocating them for every stream would cost as much as tracing it.
    std::vector<Ray> rays_;
    std::vector<Clipped> parts_;
    std::vector<std::size_t> places_;
    std::vector<Hit> found_;
    std::vector<std::uint8_t> blocked_;
};

class ClipIntersector final : public Intersector {
public:
    ClipIntersector(std::shared_ptr<const Intersector> shape, std::vector<ClipPlane> planes)
        : shape_(std::move(shape)), planes_(std::move(planes)) {}

    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<ClipTracer>(*shape_, planes_); }
    std::string_view name() const override { return shape_->name(); }
    Box bounds() const override { return shape_->bounds(); }
    double voxelSize() const override { return shape_->voxelSize(); }
    std::size_t bytes() const override { return shape_->bytes(); }
    double surfaceOffset() const override { return shape_->surfaceOffset(); }

private:
    const std::shared_ptr<const Intersector> shape_;
    const std::vector<ClipPlane> planes_;  // normals of unit length
};

}  // namespace

std::shared_ptr<const Intersector> makeClipIntersector(std::shared_ptr<const Intersector> shape,
                                                       std::vector<ClipPlane> planes) {
    for (ClipPlane& plane : planes) {
        const double length = glm::length(plane.normal);
        if (!(length > 0.0 && std::isfinite(length) && std::isfinite(plane.offset)))
            throw UsageError("--clip: the plane's normal and offset must be finite numbers, and the normal not zero");
        plane.normal /= length;
        plane.offset /= length;
    }
    if (planes.empty()) return shape;
    return std::make_shared<ClipIntersector>(std::move(shape), std::move(planes));
}

}  // namespace stratum::trace
