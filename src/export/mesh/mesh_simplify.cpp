#include "export/mesh/mesh_simplify.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace stratum::exporter {
namespace {

using openvdb::Vec3d;

constexpr std::uint32_t kNone = SurfaceMesh::kNone;
// Shares of the allowed squared error, by pass: flat areas are collapsed first. The last one is repeated.
constexpr std::array kSchedule{0.0005, 0.005, 0.03, 0.1, 0.25, 0.5, 1.0};
constexpr std::size_t kMostPasses = 24;
// Root mean square distance from the planes, as a share of the allowed error: the largest is about twice that.
constexpr double kMeanShare = 0.45;
constexpr double kEnough = 0.01;        // a pass that removes a smaller share of the faces is the last
constexpr double kLeastCosine = 0.35;   // between a face's normals before and after a step
constexpr double kLeastSine = 0.003;    // of the flattest corner of a new face
constexpr std::size_t kMostFaces = 48;  // around a point: the work at it grows with the square

// Sum of squared distances to planes by their weights: p' A p + 2 b p + c.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, c = 0, weight = 0;

    void addPlane(const Vec3d& n, double d, double w) {
        xx += w * n[0] * n[0], xy += w * n[0] * n[1], xz += w * n[0] * n[2];
        yy += w * n[1] * n[1], yz += w * n[1] * n[2], zz += w * n[2] * n[2];
        x += w * n[0] * d, y += w * n[1] * d, z += w * n[2] * d;
        c += w * d * d;
        weight += w;
    }
    void add(const Quadric& q) {
        xx += q.xx, xy += q.xy, xz += q.xz, yy += q.yy, yz += q.yz, zz += q.zz;
        x += q.x, y += q.y, z += q.z, c += q.c, weight += q.weight;
    }
    double at(const Vec3d& p) const {
        return p[0] * (xx * p[0] + 2 * (xy * p[1] + xz * p[2] + x)) + p[1] * (yy * p[1] + 2 * (yz * p[2] + y)) +
               p[2] * (zz * p[2] + 2 * z) + c;
    }
    // Its minimum, if the planes determine a point well.
    bool least(Vec3d& p) const {
        const double a = yy * zz - yz * yz;
        const double b = xz * yz - xy * zz;
        const double d = xy * yz - xz * yy;
        const double determinant = xx * a + xy * b + xz * d;
        const double trace = xx + yy + zz;
        if (!(determinant > 1e-4 * trace * trace * trace)) return false;
        const double e = xx * zz - xz * xz;
        const double f = xy * xz - xx * yz;
        const double g = xx * yy - xy * xy;
        p = Vec3d(-(a * x + b * y + d * z), -(b * x + e * y + f * z), -(d * x + f * y + g * z)) / determinant;
        return true;
    }
};

// A small vector without heap allocation.
template <typename T, std::size_t kMost>
struct Few {
    std::array<T, kMost> items;
    std::size_t count = 0;
    bool add(const T& item) {
        if (count == kMost) return false;
        items[count++] = item;
        return true;
    }
    const T* begin() const { return items.data(); }
    const T* end() const { return items.data() + count; }
    bool has(const T& item) const { return std::find(begin(), end(), item) != end(); }
};
using Around = Few<std::uint32_t, kMostFaces>;

class Simplifier {
public:
    Simplifier(const SurfaceMesh& mesh, double error, std::span<const std::uint32_t> labels)
        : labels_(labels), scale_(1 / error), origin_(mesh.points.empty() ? Vec3d(0) : Vec3d(mesh.points.front())) {
        points_.reserve(mesh.points.size());
        for (const openvdb::Vec3s& p : mesh.points) points_.push_back((Vec3d(p) - origin_) * scale_);
        faces_.reserve(mesh.triangleCount());
        mesh.forEachTriangle([&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { faces_.push_back({a, b, c}); });
        first_.assign(points_.size(), kNone);
        next_.resize(3 * faces_.size());
        for (std::uint32_t corner = static_cast<std::uint32_t>(next_.size()); corner-- > 0;) {
            std::uint32_t& first = first_[faces_[corner / 3][corner % 3]];
            next_[corner] = std::exchange(first, corner);
        }
        quadrics_.resize(points_.size());
        for (const Face& face : faces_) {
            Vec3d n = normalOf(points_[face[0]], points_[face[1]], points_[face[2]]);
            const double twice_area = n.length();
            if (!n.normalize()) continue;
            const double d = -n.dot(points_[face[0]]);
            for (const std::uint32_t point : face) quadrics_[point].addPlane(n, d, twice_area);
        }
        moved_.assign(points_.size(), 0);
    }

    void run() {
        std::size_t alive = faces_.size();
        for (std::size_t pass = 0; pass < kMostPasses; ++pass) {
            limit_ = kMeanShare * kMeanShare * kSchedule[std::min(pass, kSchedule.size() - 1)];
            pass_ = static_cast<std::uint8_t>(pass + 1);
            const std::size_t gone = once();
            alive -= gone;
            if (pass + 1 >= kSchedule.size() && static_cast<double>(gone) < kEnough * static_cast<double>(alive)) break;
        }
    }

    std::vector<std::uint32_t> store(SurfaceMesh& mesh) const {
        std::vector<std::uint32_t> place(points_.size(), kNone);
        std::vector<std::uint32_t> labels;
        for (const Face& face : faces_)
            if (face[0] != kNone)
                for (const std::uint32_t point : face) place[point] = 0;
        std::uint32_t count = 0;
        for (std::size_t n = 0; n < points_.size(); ++n) {
            if (place[n] == kNone) continue;
            mesh.points[count] = openvdb::Vec3s(points_[n] / scale_ + origin_);
            if (!labels_.empty()) labels.push_back(labels_[n]);
            place[n] = count++;
        }
        mesh.points.resize(count);
        mesh.faces.clear();
        for (const Face& face : faces_)
            if (face[0] != kNone) mesh.faces.push_back({place[face[0]], place[face[1]], place[face[2]], kNone});
        return labels;
    }

private:
    using Face = std::array<std::uint32_t, 3>;

    static Vec3d normalOf(const Vec3d& a, const Vec3d& b, const Vec3d& c) { return (b - a).cross(c - a); }

    // One pass over all edges; a point that was moved is skipped until the next pass. Returns the number of removed
    // faces.
    std::size_t once() {
        std::size_t gone = 0;
        for (std::size_t f = 0; f < faces_.size(); ++f)
            for (std::size_t n = 0; n < 3 && faces_[f][0] != kNone; ++n) {
                const std::uint32_t a = faces_[f][n];
                const std::uint32_t b = faces_[f][(n + 1) % 3];
                // From the face that has it upwards, so once.
                if (a > b || moved_[a] == pass_ || moved_[b] == pass_) continue;
                if (collapse(a, b)) gone += 2;
            }
        return gone;
    }

    bool collapse(std::uint32_t a, std::uint32_t b) {
        Quadric quadric = quadrics_[a];
        quadric.add(quadrics_[b]);
        Vec3d p(0);
        if (!placeFor(quadric, a, b, p)) return false;
        Around faces_a;
        Around faces_b;
        if (!facesOf(a, faces_a) || !facesOf(b, faces_b) || !linked(a, b, faces_a, faces_b)) return false;
        if (turns(faces_a, a, b, p) || turns(faces_b, b, a, p)) return false;
        points_[a] = p;
        quadrics_[a] = quadric;
        moved_[a] = pass_;
        for (const std::uint32_t f : faces_b) {
            Face& face = faces_[f];
            if (std::find(face.begin(), face.end(), a) != face.end())
                face[0] = kNone;
            else
                *std::find(face.begin(), face.end(), b) = a;
        }
        // Removed faces are deleted from the list when it is read next.
        std::uint32_t* end = &first_[a];
        while (*end != kNone) end = &next_[*end];
        *end = std::exchange(first_[b], kNone);
        return true;
    }

    bool placeFor(const Quadric& quadric, std::uint32_t a, std::uint32_t b, Vec3d& p) const {
        const Vec3d& pa = points_[a];
        const Vec3d& pb = points_[b];
        if (!labels_.empty() && labels_[a] != labels_[b]) return false;
        // Not far from the edge, even if the planes intersect there.
        if (quadric.least(p) && (p - 0.5 * (pa + pb)).lengthSqr() < (pa - pb).lengthSqr() &&
            quadric.at(p) <= limit_ * quadric.weight)
            return true;
        double least = limit_ * quadric.weight;
        bool found = false;
        for (const Vec3d& at : {0.5 * (pa + pb), pa, pb})
            if (const double error = quadric.at(at); error <= least) {
                least = error;
                p = at;
                found = true;
            }
        return found;
    }

    // The faces at a point; false if they are too many. Deletes removed ones from the list.
    bool facesOf(std::uint32_t point, Around& out) {
        std::uint32_t* corner = &first_[point];
        while (*corner != kNone) {
            if (faces_[*corner / 3][0] == kNone) {
                *corner = next_[*corner];
                continue;
            }
            if (!out.add(*corner / 3)) return false;
            corner = &next_[*corner];
        }
        return true;
    }

    // Whether the edge has two faces and its ends no neighbours in common but those of these faces: then a collapse
    // changes no topology. With labels, whether all around has the same one.
    bool linked(std::uint32_t a, std::uint32_t b, const Around& faces_a, const Around& faces_b) const {
        std::size_t shared = 0;
        Few<std::uint32_t, 2 * kMostFaces> near_a;
        for (const std::uint32_t f : faces_a)
            for (const std::uint32_t point : faces_[f]) {
                shared += point == b ? 1 : 0;
                if (point != a && !near_a.has(point)) near_a.add(point);
            }
        // Collapsing an edge of a tetrahedron would leave two equal faces.
        if (shared != 2 || faces_a.count + faces_b.count < 7) return false;
        Few<std::uint32_t, 2 * kMostFaces> near_b;
        std::size_t common = 0;
        for (const std::uint32_t f : faces_b)
            for (const std::uint32_t point : faces_[f]) {
                if (point == b || near_b.has(point)) continue;
                near_b.add(point);
                common += point != a && near_a.has(point) ? 1 : 0;
            }
        if (common != 2) return false;
        if (labels_.empty()) return true;
        const auto same = [&](std::uint32_t point) { return labels_[point] == labels_[a]; };
        return std::all_of(near_a.begin(), near_a.end(), same) && std::all_of(near_b.begin(), near_b.end(), same);
    }

    // Whether a face at `from`, without `other`, turns too far or gets too thin if `from` moves to `p`.
    bool turns(const Around& faces, std::uint32_t from, std::uint32_t other, const Vec3d& p) const {
        for (const std::uint32_t f : faces) {
            const Face& face = faces_[f];
            if (std::find(face.begin(), face.end(), other) != face.end()) continue;
            Vec3d corner[3];
            for (std::size_t n = 0; n < 3; ++n) corner[n] = points_[face[n]];
            const Vec3d before = normalOf(corner[0], corner[1], corner[2]);
            for (std::size_t n = 0; n < 3; ++n)
                if (face[n] == from) corner[n] = p;
            const Vec3d after = normalOf(corner[0], corner[1], corner[2]);
            const double longest = std::max({(corner[1] - corner[0]).lengthSqr(), (corner[2] - corner[1]).lengthSqr(),
                                             (corner[0] - corner[2]).lengthSqr()});
            if (!(after.length() > kLeastSine * longest)) return true;
            if (before.dot(after) < kLeastCosine * before.length() * after.length()) return true;
        }
        return false;
    }

    const std::span<const std::uint32_t> labels_;
    const double scale_;  // to units of the error
    const Vec3d origin_;
    std::vector<Vec3d> points_;
    std::vector<Quadric> quadrics_;
    std::vector<Face> faces_;           // the first corner of a removed face is kNone
    std::vector<std::uint32_t> first_;  // by point: a corner (three times the face and which) at it
    std::vector<std::uint32_t> next_;   // by corner: the next at that point
    std::vector<std::uint8_t> moved_;   // by point: the pass
    double limit_ = 0;
    std::uint8_t pass_ = 0;
};

}  // namespace

std::vector<std::uint32_t> simplify(SurfaceMesh& mesh, double error, std::span<const std::uint32_t> labels) {
    Simplifier simplifier(mesh, error, labels);
    simplifier.run();
    return simplifier.store(mesh);
}

}  // namespace stratum::exporter
