#include "embree_intersector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace stratum::bench {
namespace {

using trace::Box;
using trace::Hit;
using trace::Ray;

constexpr std::size_t kPacket = 16;

// The part of a ray that lies in the box.
struct Part {
    double begin = 0, end = 0;
    bool empty() const { return !(begin <= end); }
};

Part clip(const Ray& ray, const Box& box) {
    Part part{ray.t_min, ray.t_max};
    for (int k = 0; k < 3; ++k) {
        if (ray.direction[k] == 0.0) {
            if (ray.origin[k] < box.min[k] || ray.origin[k] > box.max[k]) return {1, 0};
            continue;
        }
        const double a = (box.min[k] - ray.origin[k]) / ray.direction[k];
        const double b = (box.max[k] - ray.origin[k]) / ray.direction[k];
        part.begin = std::max(part.begin, std::min(a, b));
        part.end = std::min(part.end, std::max(a, b));
    }
    return part;
}

class EmbreeTracer final : public trace::Tracer {
public:
    EmbreeTracer(RTCScene scene, const Box& box, const std::vector<std::uint32_t>& objects)
        : scene_(scene), box_(box), objects_(objects) {}

    bool intersect(const Ray& ray, Hit& hit) override {
        const Part part = clip(ray, box_);
        if (part.empty()) return false;
        RTCRayHit one{single(ray, part), {}};
        one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        intersectOne(scene_, one);
        if (one.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
        store(ray, part, static_cast<double>(one.ray.tfar), {one.hit.Ng_x, one.hit.Ng_y, one.hit.Ng_z}, one.hit.primID,
              hit);
        return true;
    }

    bool occluded(const Ray& ray) override {
        const Part part = clip(ray, box_);
        if (part.empty()) return false;
        RTCRay one = single(ray, part);
        occludedOne(scene_, one);
        return one.tfar < 0;
    }

    void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) override {
        for (std::size_t first = 0; first < rays.size(); first += kPacket) {
            RTCRayHit16 packet;
            alignas(64) int valid[kPacket];
            Part parts[kPacket];
            fill(rays.subspan(first, std::min(kPacket, rays.size() - first)), packet.ray, valid, parts);
            std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
            intersectPacket(scene_, valid, packet);
            for (std::size_t k = 0; k < kPacket && first + k < rays.size(); ++k) {
                Hit& hit = hits[first + k];
                if (valid[k] == 0 || packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID)
                    hit.t = std::numeric_limits<double>::infinity();
                else
                    store(rays[first + k], parts[k], static_cast<double>(packet.ray.tfar[k]),
                          {packet.hit.Ng_x[k], packet.hit.Ng_y[k], packet.hit.Ng_z[k]}, packet.hit.primID[k], hit);
            }
        }
    }

    void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) override {
        for (std::size_t first = 0; first < rays.size(); first += kPacket) {
            RTCRay16 packet;
            alignas(64) int valid[kPacket];
            Part parts[kPacket];
            fill(rays.subspan(first, std::min(kPacket, rays.size() - first)), packet, valid, parts);
            occludedPacket(scene_, valid, packet);
            for (std::size_t k = 0; k < kPacket && first + k < rays.size(); ++k)
                blocked[first + k] = valid[k] != 0 && packet.tfar[k] < 0 ? 1 : 0;
        }
    }

private:
    static RTCRay single(const Ray& ray, const Part& part) {
        const glm::vec3 origin(ray.origin + part.begin * ray.direction);
        const glm::vec3 direction(ray.direction);
        return {origin.x,    origin.y,    origin.z,
                0.0F,        direction.x, direction.y,
                direction.z, 0.0F,        static_cast<float>(part.end - part.begin),
                ~0U,         0,           0};
    }

    void fill(std::span<const Ray> rays, RTCRay16& packet, int* valid, Part* parts) const {
        for (std::size_t k = 0; k < kPacket; ++k) {
            valid[k] = 0;
            if (k >= rays.size()) continue;
            parts[k] = clip(rays[k], box_);
            if (parts[k].empty()) continue;
            valid[k] = -1;
            const glm::vec3 origin(rays[k].origin + parts[k].begin * rays[k].direction);
            packet.org_x[k] = origin.x;
            packet.org_y[k] = origin.y;
            packet.org_z[k] = origin.z;
            packet.dir_x[k] = static_cast<float>(rays[k].direction.x);
            packet.dir_y[k] = static_cast<float>(rays[k].direction.y);
            packet.dir_z[k] = static_cast<float>(rays[k].direction.z);
            packet.tnear[k] = 0;
            packet.tfar[k] = static_cast<float>(parts[k].end - parts[k].begin);
            packet.time[k] = 0;
            packet.mask[k] = ~0U;
            packet.id[k] = 0;
            packet.flags[k] = 0;
        }
    }

    void store(const Ray& ray, const Part& part, double t, const glm::dvec3& normal, std::uint32_t primitive,
               Hit& hit) const {
        hit.t = part.begin + t;
        hit.position = ray.origin + hit.t * ray.direction;
        hit.normal = glm::normalize(normal);
        hit.object = objects_.empty() ? 0 : objects_[primitive];
    }

    RTCScene scene_;
    Box box_;
    const std::vector<std::uint32_t>& objects_;
};

class EmbreeIntersector final : public trace::Intersector {
public:
    EmbreeIntersector(std::unique_ptr<EmbreeScene> scene, std::vector<std::uint32_t> objects)
        : scene_(std::move(scene)), objects_(std::move(objects)) {
        RTCBounds b;
        rtcGetSceneBounds(scene_->handle(), &b);
        box_ = {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
        double largest = 0;
        for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(box_.min[k]), std::abs(box_.max[k])});
        // A few units in the last place of what Embree counts in.
        offset_ = 64 * 0x1p-24 * largest;
        box_.min -= offset_;
        box_.max += offset_;
    }
    std::unique_ptr<trace::Tracer> makeTracer() const override {
        return std::make_unique<EmbreeTracer>(scene_->handle(), box_, objects_);
    }
    std::string_view name() const override { return "embree"; }
    Box bounds() const override { return box_; }
    double voxelSize() const override { return offset_; }
    std::size_t bytes() const override { return scene_->bytes(); }
    double surfaceOffset() const override { return offset_; }

private:
    std::unique_ptr<EmbreeScene> scene_;
    std::vector<std::uint32_t> objects_;
    Box box_;
    double offset_ = 0;
};

}  // namespace

std::unique_ptr<trace::Intersector> embreeIntersector(std::unique_ptr<EmbreeScene> scene,
                                                      std::vector<std::uint32_t> objects) {
    return std::make_unique<EmbreeIntersector>(std::move(scene), std::move(objects));
}

}  // namespace stratum::bench
