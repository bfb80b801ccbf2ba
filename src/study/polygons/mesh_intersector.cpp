#include "study/polygons/mesh_intersector.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace stratum::study {
namespace {

struct Face {
    glm::dvec3 corner, along, across;  // a corner and the edges that leave it
    std::uint32_t object;
};

// Distance to a face, or infinite.
double meet(const Face& face, const trace::Ray& ray) {
    constexpr double kNothing = std::numeric_limits<double>::infinity();
    const glm::dvec3 p = glm::cross(ray.direction, face.across);
    const double determinant = glm::dot(face.along, p);
    if (!(determinant > 0)) return kNothing;  // seen from behind, or along
    const glm::dvec3 from = ray.origin - face.corner;
    const double u = glm::dot(from, p);
    if (u < 0 || u > determinant) return kNothing;
    const glm::dvec3 q = glm::cross(from, face.along);
    const double v = glm::dot(ray.direction, q);
    if (v < 0 || u + v > determinant) return kNothing;
    const double t = glm::dot(face.across, q) / determinant;
    return t >= ray.t_min && t <= ray.t_max ? t : kNothing;
}

class MeshTracer final : public trace::Tracer {
public:
    explicit MeshTracer(const std::vector<Face>& faces) : faces_(faces) {}
    bool intersect(const trace::Ray& ray, trace::Hit& hit) override {
        const Face* nearest = nullptr;
        double least = std::numeric_limits<double>::infinity();
        for (const Face& face : faces_) {
            const double t = meet(face, ray);
            if (!(t < least)) continue;
            least = t;
            nearest = &face;
        }
        if (nearest == nullptr) return false;
        hit.t = least;
        hit.position = ray.origin + least * ray.direction;
        hit.normal = glm::normalize(glm::cross(nearest->along, nearest->across));
        hit.object = nearest->object;
        return true;
    }
    bool occluded(const trace::Ray& ray) override {
        return std::any_of(faces_.begin(), faces_.end(), [&](const Face& f) { return std::isfinite(meet(f, ray)); });
    }

private:
    const std::vector<Face>& faces_;
};

class MeshIntersector final : public trace::Intersector {
public:
    explicit MeshIntersector(const TriangleMesh& mesh) {
        for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
            const glm::uvec3& t = mesh.triangles[n];
            const glm::dvec3 a = mesh.corners[t.x];
            faces_.push_back({a, mesh.corners[t.y] - a, mesh.corners[t.z] - a, mesh.objects[n]});
        }
        box_ = {glm::dvec3(std::numeric_limits<double>::infinity()),
                glm::dvec3(-std::numeric_limits<double>::infinity())};
        double largest = 0;
        for (const glm::dvec3& p : mesh.corners) {
            box_.min = glm::min(box_.min, p);
            box_.max = glm::max(box_.max, p);
            for (int k = 0; k < 3; ++k) largest = std::max(largest, std::abs(p[k]));
        }
        offset_ = 64 * 0x1p-53 * largest;  // a few units in the last place
    }
    std::unique_ptr<trace::Tracer> makeTracer() const override { return std::make_unique<MeshTracer>(faces_); }
    std::string_view name() const override { return "mesh"; }
    trace::Box bounds() const override { return box_; }
    double voxelSize() const override { return offset_; }
    std::size_t bytes() const override { return faces_.size() * sizeof(Face); }
    double surfaceOffset() const override { return offset_; }

private:
    std::vector<Face> faces_;
    trace::Box box_;
    double offset_ = 0;
};

}  // namespace

std::unique_ptr<trace::Intersector> makeMeshIntersector(const TriangleMesh& mesh) {
    return std::make_unique<MeshIntersector>(mesh);
}

}  // namespace stratum::study
