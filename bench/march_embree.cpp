#include "march_embree.h"

#include "embree_scene.h"

#include <fmt/format.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace stratum::bench {
namespace {

constexpr std::size_t kPacket = 16;

// Rays in Embree's packets. Which form is best for them, packets of 16 or one by one, is tried out first.
class EmbreeRays final : public Prepared {
public:
    EmbreeRays(RTCScene scene, std::span<const trace::Ray> rays, bool coherent) : scene_(scene), count_(rays.size()) {
        flags_ = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        packets_.resize((count_ + kPacket - 1) / kPacket);
        for (std::size_t n = 0; n < count_; ++n) {
            RTCRay16& p = packets_[n / kPacket];
            const std::size_t k = n % kPacket;
            p.org_x[k] = static_cast<float>(rays[n].origin.x);
            p.org_y[k] = static_cast<float>(rays[n].origin.y);
            p.org_z[k] = static_cast<float>(rays[n].origin.z);
            p.dir_x[k] = static_cast<float>(rays[n].direction.x);
            p.dir_y[k] = static_cast<float>(rays[n].direction.y);
            p.dir_z[k] = static_cast<float>(rays[n].direction.z);
            p.tnear[k] = static_cast<float>(rays[n].t_min);
            p.tfar[k] = static_cast<float>(rays[n].t_max);
            p.mask[k] = ~0U;
        }
    }

    void nearest(std::size_t first, std::size_t last, double* t) override {
        if (usePackets(
                nearest_form_, [&] { nearestPackets(first, last, t); }, [&] { nearestSingle(first, last, t); })) {
            nearestPackets(first, last, t);
        } else {
            nearestSingle(first, last, t);
        }
    }
    void any(std::size_t first, std::size_t last, std::uint8_t* blocked) override {
        if (usePackets(
                any_form_, [&] { anyPackets(first, last, blocked); }, [&] { anySingle(first, last, blocked); }))
            anyPackets(first, last, blocked);
        else
            anySingle(first, last, blocked);
    }

private:
    // While undecided (the warm-up round) every part is traced both ways and the clock votes.
    template <typename A, typename B>
    bool usePackets(std::atomic<std::int64_t>& form, const A& packets, const B& single) {
        constexpr int kTrials = 64;
        const int trial = trials_.load();
        if (trial < kTrials) {
            const auto clock = [] {  // of this thread alone: what others do must not decide
                timespec t{};
                clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
                return std::int64_t{1000000000} * t.tv_sec + t.tv_nsec;
            };
            const auto a = clock();
            packets();
            const auto b = clock();
            single();
            const auto c = clock();
            form += (b - a) - (c - b);
            ++trials_;
        }
        return form.load() < 0;
    }

    RTCIntersectContext context() const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = flags_;
        return context;
    }
    void nearestPackets(std::size_t first, std::size_t last, double* t) const {
        RTCIntersectContext c = context();
        for (std::size_t n = first; n < last; n += kPacket) {
            RTCRayHit16 packet;
            packet.ray = packets_[n / kPacket];
            alignas(64) int valid[kPacket];
            for (std::size_t k = 0; k < kPacket; ++k) {
                valid[k] = n + k < last ? -1 : 0;
                packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(valid, scene_, &c, &packet);
            for (std::size_t k = 0; k < kPacket && n + k < last; ++k)
                t[n + k] = packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                                           : static_cast<double>(packet.ray.tfar[k]);
        }
    }
    void nearestSingle(std::size_t first, std::size_t last, double* t) const {
        RTCIntersectContext c = context();
        for (std::size_t n = first; n < last; ++n) {
            RTCRayHit one;
            one.ray = rayAt(n);
            one.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &c, &one);
            t[n] = one.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                             : static_cast<double>(one.ray.tfar);
        }
    }
    void anyPackets(std::size_t first, std::size_t last, std::uint8_t* blocked) const {
        RTCIntersectContext c = context();
        for (std::size_t n = first; n < last; n += kPacket) {
            RTCRay16 packet = packets_[n / kPacket];
            alignas(64) int valid[kPacket];
            for (std::size_t k = 0; k < kPacket; ++k) valid[k] = n + k < last ? -1 : 0;
            rtcOccluded16(valid, scene_, &c, &packet);
            for (std::size_t k = 0; k < kPacket && n + k < last; ++k) blocked[n + k] = packet.tfar[k] < 0 ? 1 : 0;
        }
    }
    void anySingle(std::size_t first, std::size_t last, std::uint8_t* blocked) const {
        RTCIntersectContext c = context();
        for (std::size_t n = first; n < last; ++n) {
            RTCRay one = rayAt(n);
            rtcOccluded1(scene_, &c, &one);
            blocked[n] = one.tfar < 0 ? 1 : 0;
        }
    }
    RTCRay rayAt(std::size_t n) const {
        const RTCRay16& p = packets_[n / kPacket];
        const std::size_t k = n % kPacket;
        RTCRay ray{};
        ray.org_x = p.org_x[k];
        ray.org_y = p.org_y[k];
        ray.org_z = p.org_z[k];
        ray.dir_x = p.dir_x[k];
        ray.dir_y = p.dir_y[k];
        ray.dir_z = p.dir_z[k];
        ray.tnear = p.tnear[k];
        ray.tfar = p.tfar[k];
        ray.mask = ~0U;
        return ray;
    }

    RTCScene scene_;
    std::size_t count_;
    RTCIntersectContextFlags flags_;
    std::vector<RTCRay16> packets_;
    std::atomic<int> trials_{0};
    std::atomic<std::int64_t> nearest_form_{0}, any_form_{0};
};

class EmbreePeer final : public Peer {
public:
    explicit EmbreePeer(std::unique_ptr<EmbreeScene> scene) : scene_(std::move(scene)) {
        bytes = static_cast<double>(scene_->bytes());
    }
    std::unique_ptr<Prepared> prepare(std::span<const trace::Ray> rays, bool coherent) override {
        return std::make_unique<EmbreeRays>(scene_->handle(), rays, coherent);
    }

private:
    std::unique_ptr<EmbreeScene> scene_;
};

template <typename Make>
std::unique_ptr<Peer> timed(std::string name, const Make& make) {
    const auto start = std::chrono::steady_clock::now();
    auto peer = std::make_unique<EmbreePeer>(make());
    peer->build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    peer->name = std::move(name);
    return peer;
}

}  // namespace

std::unique_ptr<Peer> embreeMesh(const openvdb::FloatGrid& grid) {
    return timed("embree mesh", [&] {
        std::vector<openvdb::Vec3s> points;
        std::vector<openvdb::Vec4I> faces;
        openvdb::tools::volumeToMesh(grid, points, faces, 0.0);
        std::vector<Corner> corners(points.size());
        for (std::size_t n = 0; n < points.size(); ++n) corners[n] = {points[n][0], points[n][1], points[n][2]};
        std::vector<Quad> quads(faces.size());
        for (std::size_t n = 0; n < faces.size(); ++n)
            quads[n] = {{faces[n][0], faces[n][1], faces[n][2], faces[n][3]}};
        return quadScene(corners, quads);
    });
}

std::unique_ptr<Peer> embreeBeads(const gcode::Toolpath& toolpath, double split) {
    return timed(split > 0 ? fmt::format("embree beads, {:g}:1", split) : "embree beads, whole",
                 [&] { return beadScene(toolpath, split); });
}

std::unique_ptr<Peer> embreePrisms(const gcode::Toolpath& toolpath, int corners, double split) {
    return timed(fmt::format("embree {}-gons, {:g}:1", corners, split),
                 [&] { return prismScene(toolpath, corners, split); });
}

}  // namespace stratum::bench
