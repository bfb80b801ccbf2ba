#include "march_embree.h"

#include "embree_scene.h"

#include <fmt/format.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <array>
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

// Rays in Embree's packets. Which form is best for them, packets of 16, a stream of such packets or one by one, is
// tried out first.
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
        traced(nearest_, [&](Form form) {
            form == kPackets  ? nearestPackets(first, last, t)
            : form == kStream ? nearestStream(first, last, t)
                              : nearestSingle(first, last, t);
        });
    }
    void any(std::size_t first, std::size_t last, std::uint8_t* blocked) override {
        traced(any_, [&](Form form) {
            form == kPackets  ? anyPackets(first, last, blocked)
            : form == kStream ? anyStream(first, last, blocked)
                              : anySingle(first, last, blocked);
        });
    }

private:
    enum Form { kPackets, kStream, kSingle, kForms };
    // CPU time that each form has taken so far.
    struct Votes {
        std::atomic<int> trials{0};
        std::array<std::atomic<std::int64_t>, kForms> ns{};
    };

    // While undecided (the warm-up round) every part is traced in all forms and the clock votes.
    template <typename Trace>
    static void traced(Votes& votes, const Trace& trace) {
        constexpr int kTrials = 64;
        if (votes.trials.load() < kTrials) {
            const auto clock = [] {  // of this thread alone: what others do must not decide
                timespec t{};
                clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
                return std::int64_t{1000000000} * t.tv_sec + t.tv_nsec;
            };
            for (int form = 0; form < kForms; ++form) {
                const std::int64_t start = clock();
                trace(static_cast<Form>(form));
                votes.ns[static_cast<std::size_t>(form)] += clock() - start;
            }
            ++votes.trials;
            return;
        }
        const auto best = std::min_element(votes.ns.begin(), votes.ns.end(),
                                           [](const auto& a, const auto& b) { return a.load() < b.load(); });
        trace(static_cast<Form>(best - votes.ns.begin()));
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
    // The packets from `first` on, in one call; rays past the last have no length.
    template <typename Packet, typename Init>
    std::vector<Packet> streamOf(std::size_t first, std::size_t last, const Init& init) const {
        std::vector<Packet> stream((last - first + kPacket - 1) / kPacket);
        for (std::size_t n = 0; n < stream.size(); ++n) {
            RTCRay16& ray = init(stream[n], packets_[first / kPacket + n]);
            for (std::size_t k = 0; k < kPacket; ++k)
                if (first + n * kPacket + k >= last) ray.tfar[k] = -1;
        }
        return stream;
    }
    void nearestStream(std::size_t first, std::size_t last, double* t) const {
        auto stream = streamOf<RTCRayHit16>(first, last, [](RTCRayHit16& packet, const RTCRay16& rays) -> RTCRay16& {
            packet.ray = rays;
            std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
            return packet.ray;
        });
        RTCIntersectContext c = context();
        rtcIntersectNM(scene_, &c, reinterpret_cast<RTCRayHitN*>(stream.data()), kPacket,
                       static_cast<unsigned>(stream.size()), sizeof(RTCRayHit16));
        for (std::size_t n = first; n < last; ++n) {
            const RTCRayHit16& packet = stream[(n - first) / kPacket];
            const std::size_t k = (n - first) % kPacket;
            t[n] = packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                                   : static_cast<double>(packet.ray.tfar[k]);
        }
    }
    void anyStream(std::size_t first, std::size_t last, std::uint8_t* blocked) const {
        auto stream = streamOf<RTCRay16>(first, last, [](RTCRay16& packet, const RTCRay16& rays) -> RTCRay16& {
            packet = rays;
            return packet;
        });
        RTCIntersectContext c = context();
        rtcOccludedNM(scene_, &c, reinterpret_cast<RTCRayN*>(stream.data()), kPacket,
                      static_cast<unsigned>(stream.size()), sizeof(RTCRay16));
        for (std::size_t n = first; n < last; ++n)
            blocked[n] = stream[(n - first) / kPacket].tfar[(n - first) % kPacket] < 0 ? 1 : 0;
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
    Votes nearest_, any_;
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

std::unique_ptr<Peer> embreeRound(const gcode::Toolpath& toolpath) {
    return timed("embree round curves", [&] { return roundScene(toolpath); });
}

std::unique_ptr<Peer> embreeRibbons(const gcode::Toolpath& toolpath) {
    return timed("embree flat curves", [&] { return ribbonScene(toolpath); });
}

std::unique_ptr<Peer> embreePrisms(const gcode::Toolpath& toolpath, int corners, double split) {
    return timed(fmt::format("embree {}-gons, {:g}:1", corners, split),
                 [&] { return prismScene(toolpath, corners, split); });
}

}  // namespace stratum::bench
