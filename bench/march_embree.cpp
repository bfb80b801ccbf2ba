#include "march_embree.h"

#include "parallel/parallel_for.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>
#include <span>
#include <stdexcept>
#include <vector>

namespace stratum::bench {
namespace {

constexpr std::size_t kPacket = 16;

struct Device {
    RTCDevice handle = nullptr;
    std::atomic<std::int64_t> bytes{0};
    Device() : handle(rtcNewDevice(nullptr)) {
        if (handle == nullptr) throw std::runtime_error("Embree can't make a device");
        rtcSetDeviceMemoryMonitorFunction(
            handle,
            [](void* self, ssize_t change, bool) {
                static_cast<Device*>(self)->bytes += change;
                return true;
            },
            this);
    }
    ~Device() { rtcReleaseDevice(handle); }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
};

// Rays in Embree's packets. Which form is best for them, packets of 16 or one by one, is tried out first.
class EmbreeRays final : public Prepared {
public:
    EmbreeRays(RTCScene scene, std::span<const march::Ray> rays, bool coherent) : scene_(scene), count_(rays.size()) {
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

class EmbreePeer : public Peer {
public:
    EmbreePeer() : scene_(rtcNewScene(device_.handle)) { rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST); }
    ~EmbreePeer() override { rtcReleaseScene(scene_); }
    EmbreePeer(const EmbreePeer&) = delete;
    EmbreePeer& operator=(const EmbreePeer&) = delete;
    std::unique_ptr<Prepared> prepare(std::span<const march::Ray> rays, bool coherent) override {
        return std::make_unique<EmbreeRays>(scene_, rays, coherent);
    }
    void commit(RTCGeometry geometry) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        if (rtcGetDeviceError(device_.handle) != RTC_ERROR_NONE) throw std::runtime_error("Embree refuses the scene");
        bytes = static_cast<double>(device_.bytes.load());
    }

    Device device_;
    RTCScene scene_;
};

struct Corner {
    float x, y, z;
};
struct Quad {
    std::uint32_t v[4];
};

void attachQuads(EmbreePeer& peer, std::span<const Corner> corners, std::span<const Quad> quads) {
    RTCGeometry geometry = rtcNewGeometry(peer.device_.handle, RTC_GEOMETRY_TYPE_QUAD);
    auto* v = static_cast<Corner*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                           sizeof(Corner), corners.size()));
    auto* q = static_cast<Quad*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, sizeof(Quad), quads.size()));
    std::copy(corners.begin(), corners.end(), v);
    std::copy(quads.begin(), quads.end(), q);
    peer.commit(geometry);
}

// A level straight piece of a bead: { hypot(max(rho - flat, 0), z - zc) <= radius }, rho the plan distance to the axis.
struct Piece {
    float x, y, zc;        // start of the axis
    float ux, uy, length;  // its direction and length in the plane
    float flat, radius;
};

std::vector<Piece> piecesOf(const gcode::Toolpath& toolpath, double split) {
    std::vector<Piece> pieces;
    for (const gcode::Bead& bead : toolpath.beads) {
        const gcode::Run& run = toolpath.runOf(bead);
        if (run.layer == 0) continue;  // prime lines, which gcode2vdb leaves out as well
        const double height = std::min(static_cast<double>(run.height), static_cast<double>(bead.width));
        const double dx = bead.x1 - bead.x0;
        const double dy = bead.y1 - bead.y0;
        const double length = std::hypot(dx, dy);
        const double width = static_cast<double>(bead.width);
        const int count = split > 0 ? std::max(1, static_cast<int>(std::ceil(length / (split * width)))) : 1;
        for (int k = 0; k < count; ++k) {
            const double s = static_cast<double>(k) / count;
            Piece p{};
            p.x = static_cast<float>(bead.x0 + s * dx);
            p.y = static_cast<float>(bead.y0 + s * dy);
            p.zc = static_cast<float>(bead.z0 - 0.5 * static_cast<double>(run.height));
            p.ux = length > 0 ? static_cast<float>(dx / length) : 1;
            p.uy = length > 0 ? static_cast<float>(dy / length) : 0;
            p.length = static_cast<float>(length / count);
            p.flat = static_cast<float>(0.5 * (width - height));
            p.radius = static_cast<float>(0.5 * height);
            pieces.push_back(p);
        }
    }
    return pieces;
}

// Where a ray enters a piece. The distance to a convex body is a convex function along a ray, so Newton's steps from
// outside never overshoot the first root. Negative if it misses or starts inside.
float enter(const Piece& p, const float o[3], const float d[3], float t_min, float t_max) {
    // In the piece's frame: along, across, up.
    const float ox = o[0] - p.x;
    const float oy = o[1] - p.y;
    const float a0 = ox * p.ux + oy * p.uy;
    const float b0 = oy * p.ux - ox * p.uy;
    const float z0 = o[2] - p.zc;
    const float ad = d[0] * p.ux + d[1] * p.uy;
    const float bd = d[1] * p.ux - d[0] * p.uy;
    // The slab of its flats first, and its sides.
    float t = t_min;
    float end = t_max;
    const float reach = p.flat + p.radius;
    const float slabs[3][4] = {
        {z0, d[2], -p.radius, p.radius}, {b0, bd, -reach, reach}, {a0, ad, -reach, p.length + reach}};
    for (const auto& s : slabs) {
        if (s[1] == 0) {
            if (s[0] < s[2] || s[0] > s[3]) return -1;
            continue;
        }
        const float i = 1 / s[1];
        const float n = ((i > 0 ? s[2] : s[3]) - s[0]) * i;
        const float f = ((i > 0 ? s[3] : s[2]) - s[0]) * i;
        t = std::max(t, n);
        end = std::min(end, f);
    }
    if (t > end) return -1;
    for (int step = 0; step < 24; ++step) {
        const float a = a0 + t * ad;
        const float b = b0 + t * bd;
        const float z = z0 + t * d[2];
        const float beyond = a < 0 ? a : std::max(a - p.length, 0.0F);
        const float rho = std::sqrt(beyond * beyond + b * b);
        const float out = std::max(rho - p.flat, 0.0F);
        const float r = std::sqrt(out * out + z * z);
        const float phi = r - p.radius;
        if (phi <= 1e-6F * (1 + std::abs(t))) return t > t_min || phi > -1e-6F ? t : -1;
        const float rho_slope = rho > 0 ? (beyond * ad + b * bd) / rho : 0;
        const float slope = (out * (out > 0 ? rho_slope : 0) + z * d[2]) / r;
        if (!(slope < 0)) return -1;
        t -= phi / slope;
        if (t > end) return -1;
    }
    return t;
}

void beadBounds(const RTCBoundsFunctionArguments* args) {
    const Piece& p = static_cast<const Piece*>(args->geometryUserPtr)[args->primID];
    const float reach = p.flat + p.radius;
    const float x1 = p.x + p.length * p.ux;
    const float y1 = p.y + p.length * p.uy;
    *args->bounds_o = {std::min(p.x, x1) - reach, std::min(p.y, y1) - reach, p.zc - p.radius, 0,
                       std::max(p.x, x1) + reach, std::max(p.y, y1) + reach, p.zc + p.radius, 0};
}

void beadIntersect(const RTCIntersectFunctionNArguments* args) {
    const Piece& piece = static_cast<const Piece*>(args->geometryUserPtr)[args->primID];
    RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, args->N);
    RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, args->N);
    for (unsigned n = 0; n < args->N; ++n) {
        if (args->valid[n] == 0) continue;
        const float o[3] = {RTCRayN_org_x(rays, args->N, n), RTCRayN_org_y(rays, args->N, n),
                            RTCRayN_org_z(rays, args->N, n)};
        const float d[3] = {RTCRayN_dir_x(rays, args->N, n), RTCRayN_dir_y(rays, args->N, n),
                            RTCRayN_dir_z(rays, args->N, n)};
        const float t = enter(piece, o, d, RTCRayN_tnear(rays, args->N, n), RTCRayN_tfar(rays, args->N, n));
        if (t < 0) continue;
        RTCRayN_tfar(rays, args->N, n) = t;
        RTCHitN_primID(hits, args->N, n) = args->primID;
        RTCHitN_geomID(hits, args->N, n) = args->geomID;
    }
}

void beadOccluded(const RTCOccludedFunctionNArguments* args) {
    const Piece& piece = static_cast<const Piece*>(args->geometryUserPtr)[args->primID];
    RTCRayN* rays = args->ray;
    for (unsigned n = 0; n < args->N; ++n) {
        if (args->valid[n] == 0) continue;
        const float o[3] = {RTCRayN_org_x(rays, args->N, n), RTCRayN_org_y(rays, args->N, n),
                            RTCRayN_org_z(rays, args->N, n)};
        const float d[3] = {RTCRayN_dir_x(rays, args->N, n), RTCRayN_dir_y(rays, args->N, n),
                            RTCRayN_dir_z(rays, args->N, n)};
        if (enter(piece, o, d, RTCRayN_tnear(rays, args->N, n), RTCRayN_tfar(rays, args->N, n)) >= 0)
            RTCRayN_tfar(rays, args->N, n) = -std::numeric_limits<float>::infinity();
    }
}

class BeadPeer final : public EmbreePeer {
public:
    explicit BeadPeer(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
        RTCGeometry geometry = rtcNewGeometry(device_.handle, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(pieces_.size()));
        rtcSetGeometryUserData(geometry, pieces_.data());
        rtcSetGeometryBoundsFunction(geometry, beadBounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry, beadIntersect);
        rtcSetGeometryOccludedFunction(geometry, beadOccluded);
        commit(geometry);
        bytes += static_cast<double>(pieces_.size() * sizeof(Piece));
    }

private:
    std::vector<Piece> pieces_;
};

template <typename Make>
std::unique_ptr<Peer> timed(std::string name, const Make& make) {
    const auto start = std::chrono::steady_clock::now();
    std::unique_ptr<Peer> peer = make();
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
        auto peer = std::make_unique<EmbreePeer>();
        attachQuads(*peer, corners, quads);
        return peer;
    });
}

std::unique_ptr<Peer> embreeBeads(const gcode::Toolpath& toolpath, double split) {
    return timed(split > 0 ? fmt::format("embree beads, {:g}:1", split) : "embree beads, whole",
                 [&] { return std::make_unique<BeadPeer>(piecesOf(toolpath, split)); });
}

std::unique_ptr<Peer> embreePrisms(const gcode::Toolpath& toolpath, int corners, double split) {
    return timed(fmt::format("embree {}-gons, {:g}:1", corners, split), [&] {
        std::vector<Corner> vertices;
        std::vector<Quad> quads;
        for (const Piece& p : piecesOf(toolpath, split)) {
            const auto base = static_cast<std::uint32_t>(vertices.size());
            const auto n = static_cast<std::uint32_t>(corners);
            // Points on the stadium at equal angles of its roundings; ends reach half a width on, as the nozzle does.
            for (const float along : {-0.5F * (p.flat + p.radius), p.length + 0.5F * (p.flat + p.radius)})
                for (std::uint32_t k = 0; k < n; ++k) {
                    const float angle =
                        static_cast<float>(2 * std::numbers::pi * (corners == 4 ? k : k + 0.5) / corners);
                    const float side = std::cos(angle);
                    const float b = p.radius * side + (std::abs(side) < 1e-6F ? 0 : std::copysign(p.flat, side));
                    const float z = p.radius * std::sin(angle);
                    vertices.push_back({p.x + along * p.ux - b * p.uy, p.y + along * p.uy + b * p.ux, p.zc + z});
                }
            for (std::uint32_t k = 0; k < n; ++k) {
                const std::uint32_t next = (k + 1) % n;
                quads.push_back({{base + k, base + next, base + n + next, base + n + k}});
            }
            for (std::uint32_t end = 0; end < 2; ++end)
                for (std::uint32_t k = 1; k + 2 < n; k += 2)
                    quads.push_back(
                        {{base + end * n, base + end * n + k, base + end * n + k + 1, base + end * n + k + 2}});
        }
        auto peer = std::make_unique<EmbreePeer>();
        attachQuads(*peer, vertices, quads);
        return peer;
    });
}

}  // namespace stratum::bench
