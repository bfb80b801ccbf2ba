#include "embree_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace stratum::bench {
namespace {

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

class Committed : public EmbreeScene {
public:
    Committed() : scene_(rtcNewScene(device_.handle)) { rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST); }
    ~Committed() override { rtcReleaseScene(scene_); }
    RTCScene handle() const override { return scene_; }
    std::size_t bytes() const override { return static_cast<std::size_t>(device_.bytes.load()) + own_bytes_; }
    std::size_t primitives() const override { return primitives_; }

protected:
    void commit(RTCGeometry geometry, std::size_t primitives, std::size_t own_bytes) {
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
        if (rtcGetDeviceError(device_.handle) != RTC_ERROR_NONE) throw std::runtime_error("Embree refuses the scene");
        primitives_ = primitives;
        own_bytes_ = own_bytes;
    }
    Device device_;

private:
    RTCScene scene_;
    std::size_t primitives_ = 0, own_bytes_ = 0;
};

template <typename Face>
class MeshScene final : public Committed {
public:
    MeshScene(RTCGeometryType type, RTCFormat format, std::span<const Corner> corners, std::span<const Face> faces) {
        RTCGeometry geometry = rtcNewGeometry(device_.handle, type);
        auto* v = static_cast<Corner*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               sizeof(Corner), corners.size()));
        auto* f = static_cast<Face*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, format, sizeof(Face), faces.size()));
        std::copy(corners.begin(), corners.end(), v);
        std::copy(faces.begin(), faces.end(), f);
        commit(geometry, faces.size(), 0);
    }
};

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

// The gradient of that distance at a point of the surface.
std::array<float, 3> normalAt(const Piece& p, float x, float y, float z) {
    const float a = (x - p.x) * p.ux + (y - p.y) * p.uy;
    const float b = (y - p.y) * p.ux - (x - p.x) * p.uy;
    const float beyond = a < 0 ? a : std::max(a - p.length, 0.0F);
    const float rho = std::sqrt(beyond * beyond + b * b);
    const float side = rho > p.flat ? (rho - p.flat) / rho : 0;
    return {side * (beyond * p.ux - b * p.uy), side * (beyond * p.uy + b * p.ux), z - p.zc};
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
        const auto [nx, ny, nz] = normalAt(piece, o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]);
        RTCHitN_Ng_x(hits, args->N, n) = nx;
        RTCHitN_Ng_y(hits, args->N, n) = ny;
        RTCHitN_Ng_z(hits, args->N, n) = nz;
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

class CurveScene final : public Committed {
public:
    CurveScene(RTCGeometryType type, const std::vector<Piece>& pieces, float (*radius)(const Piece&)) {
        RTCGeometry geometry = rtcNewGeometry(device_.handle, type);
        auto* v = static_cast<std::array<float, 4>*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), 2 * pieces.size()));
        auto* first = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, sizeof(std::uint32_t), pieces.size()));
        for (std::size_t n = 0; n < pieces.size(); ++n) {
            const Piece& p = pieces[n];
            const float r = radius(p);
            v[2 * n] = {p.x, p.y, p.zc, r};
            v[2 * n + 1] = {p.x + p.length * p.ux, p.y + p.length * p.uy, p.zc, r};
            first[n] = static_cast<std::uint32_t>(2 * n);
        }
        commit(geometry, pieces.size(), 0);
    }
};

class BeadScene final : public Committed {
public:
    explicit BeadScene(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
        RTCGeometry geometry = rtcNewGeometry(device_.handle, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(pieces_.size()));
        rtcSetGeometryUserData(geometry, pieces_.data());
        rtcSetGeometryBoundsFunction(geometry, beadBounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry, beadIntersect);
        rtcSetGeometryOccludedFunction(geometry, beadOccluded);
        commit(geometry, pieces_.size(), pieces_.size() * sizeof(Piece));
    }

private:
    std::vector<Piece> pieces_;
};

}  // namespace

std::unique_ptr<EmbreeScene> quadScene(std::span<const Corner> corners, std::span<const Quad> quads) {
    return std::make_unique<MeshScene<Quad>>(RTC_GEOMETRY_TYPE_QUAD, RTC_FORMAT_UINT4, corners, quads);
}

std::unique_ptr<EmbreeScene> triangleScene(std::span<const Corner> corners, std::span<const Triangle> triangles) {
    return std::make_unique<MeshScene<Triangle>>(RTC_GEOMETRY_TYPE_TRIANGLE, RTC_FORMAT_UINT3, corners, triangles);
}

std::unique_ptr<EmbreeScene> beadScene(const gcode::Toolpath& toolpath, double split) {
    return std::make_unique<BeadScene>(piecesOf(toolpath, split));
}

std::unique_ptr<EmbreeScene> roundScene(const gcode::Toolpath& toolpath) {
    return std::make_unique<CurveScene>(RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, piecesOf(toolpath, 0),
                                        [](const Piece& p) {
                                            const float pi = std::numbers::pi_v<float>;
                                            return std::sqrt(p.radius * (p.radius + 4 * p.flat / pi));
                                        });
}

std::unique_ptr<EmbreeScene> ribbonScene(const gcode::Toolpath& toolpath) {
    return std::make_unique<CurveScene>(RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE, piecesOf(toolpath, 0),
                                        [](const Piece& p) { return p.flat + p.radius; });
}

std::unique_ptr<EmbreeScene> prismScene(const gcode::Toolpath& toolpath, int corners, double split) {
    std::vector<Corner> vertices;
    std::vector<Quad> quads;
    for (const Piece& p : piecesOf(toolpath, split)) {
        const auto base = static_cast<std::uint32_t>(vertices.size());
        const auto n = static_cast<std::uint32_t>(corners);
        // Points on the stadium at equal angles of its roundings; ends reach half a width on, as the nozzle does.
        for (const float along : {-0.5F * (p.flat + p.radius), p.length + 0.5F * (p.flat + p.radius)})
            for (std::uint32_t k = 0; k < n; ++k) {
                const float angle = static_cast<float>(2 * std::numbers::pi * (corners == 4 ? k : k + 0.5) / corners);
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
                quads.push_back({{base + end * n, base + end * n + k, base + end * n + k + 1, base + end * n + k + 2}});
    }
    return quadScene(vertices, quads);
}

}  // namespace stratum::bench
