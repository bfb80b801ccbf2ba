#include "trace/scene_intersector.h"

#include "base/error.h"
#include "trace/box_corners.h"
#include "trace/box_tree.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace stratum::trace {
namespace {

Box boxOf(const SceneObject& object) {
    const Box own = object.shape->bounds();
    if (!hasEnd(own)) return {glm::dvec3(-kInfinity), glm::dvec3(kInfinity)};
    Box box{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)};
    for (const glm::dvec3& corner : cornersOf(own)) {
        const glm::dvec3 world = object.placement.linear * corner + object.placement.offset;
        box.min = glm::min(box.min, world);
        box.max = glm::max(box.max, world);
    }
    return box;
}

/// One object, ready for rays.
struct Member {
    std::shared_ptr<const Intersector> shape;
    Box box;                      // world space
    glm::dmat3 to_own{1.0};       // directions
    glm::dmat3 normals_out{1.0};  // inverse transpose
    glm::dvec3 offset{0.0};       // world units
    glm::dmat3 linear{1.0};
    double most_stretch = 1.0;  // longest image of a unit vector
    bool turned = false;        // whether `linear` is more than 1

    /// `stretch` is own units per world unit along the ray.
    Ray inOwnSpace(const Ray& ray, double& stretch) const {
        Ray own = ray;
        own.origin = ray.origin - offset;
        stretch = 1.0;
        if (!turned) return own;
        own.origin = to_own * own.origin;
        own.direction = to_own * ray.direction;
        stretch = glm::length(own.direction);
        own.direction /= stretch;
        own.t_min *= stretch;
        own.t_max *= stretch;
        return own;
    }
    Hit inWorld(const Hit& own, const Ray& ray, double stretch, std::uint32_t object) const {
        Hit hit = own;
        hit.object = object;
        hit.t = own.t / stretch;
        hit.position = ray.origin + hit.t * ray.direction;
        if (turned) hit.normal = glm::normalize(normals_out * own.normal);
        return hit;
    }
    /// Maps the hit back to the shape's own space, except t.
    Hit backIn(const Hit& hit) const {
        Hit own = hit;
        own.object = 0;
        own.position = hit.position - offset;
        if (!turned) return own;
        own.position = to_own * own.position;
        // normals_out is the inverse transpose of `linear`; its inverse is the transpose of `linear`.
        own.normal = glm::normalize(hit.normal * linear);
        return own;
    }
};

struct Members {
    std::vector<Member> all;
    std::optional<BoxTree> tree;  // if there are many
};

// Objects are always traced in the order of their indices, each up to the nearest hit so far; the tree only skips
// objects whose box the ray misses. So results don't depend on the tree, even where objects touch.
class SceneTracer final : public Tracer {
public:
    explicit SceneTracer(const Members& members) : members_(members.all), tree_(members.tree) {
        for (const Member& member : members_) tracers_.push_back(member.shape->makeTracer());
    }

    bool intersect(const Ray& ray, Hit& hit) override {
        const BoxTest test(ray);
        Ray rest = ray;
        bool found = false;
        const auto tryMember = [&](std::uint32_t m) {
            if (!test.meets(members_[m].box, rest.t_max)) return;
            double stretch = 1.0;
            const Ray own = members_[m].inOwnSpace(rest, stretch);
            Hit here;
            if (!tracers_[m]->intersect(own, here)) return;
            const Hit there = members_[m].inWorld(here, ray, stretch, m);
            // Where two objects touch, the first one in the list is hit, in streams as well.
            if (found && !(there.t < hit.t)) return;
            hit = there;
            rest.t_max = hit.t;
            found = true;
        };
        if (!tree_) {
            for (std::uint32_t m = 0; m < members_.size(); ++m) tryMember(m);
            return found;
        }
        met_.clear();
        tree_->visit(test, ray.t_max, [this](std::uint32_t m) {
            met_.push_back(m);
            return false;
        });
        std::sort(met_.begin(), met_.end());
        for (const std::uint32_t m : met_) tryMember(m);
        return found;
    }

    bool occluded(const Ray& ray) override {
        const BoxTest test(ray);
        const auto blocks = [&](std::uint32_t m) {
            double stretch = 1.0;
            return tracers_[m]->occluded(members_[m].inOwnSpace(ray, stretch));
        };
        if (tree_) return tree_->visit(test, ray.t_max, blocks);
        for (std::uint32_t m = 0; m < members_.size(); ++m)
            if (test.meets(members_[m].box, ray.t_max) && blocks(m)) return true;
        return false;
    }

    // Object by object, so that each gets one stream.
    void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) override {
        for (Hit& hit : hits) hit.t = kInfinity;
        listMet(rays);
        for (std::uint32_t m = 0; m < members_.size(); ++m) {
            if (!gather(m, rays, [&](std::size_t n) { return hits[n].t; })) continue;
            own_hits_.assign(own_.size(), Hit{});
            tracers_[m]->intersectStream(own_, own_hits_);
            for (std::size_t k = 0; k < own_.size(); ++k) {
                if (!std::isfinite(own_hits_[k].t)) continue;
                const std::size_t n = places_[k];
                const Hit there = members_[m].inWorld(own_hits_[k], rays[n], stretches_[k], m);
                if (there.t < hits[n].t) hits[n] = there;
            }
        }
    }

    void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) override {
        std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
        listMet(rays);
        for (std::uint32_t m = 0; m < members_.size(); ++m) {
            if (!gather(m, rays, [&](std::size_t n) { return blocked[n] != 0 ? -kInfinity : kInfinity; })) continue;
            own_blocked_.assign(own_.size(), 0);
            tracers_[m]->occludedStream(own_, own_blocked_);
            for (std::size_t k = 0; k < own_.size(); ++k) blocked[places_[k]] |= own_blocked_[k];
        }
    }

    glm::dvec3 shadingNormal(const Hit& hit) override {
        const Member& member = members_[hit.object];
        const glm::dvec3 own = tracers_[hit.object]->shadingNormal(member.backIn(hit));
        return member.turned ? glm::normalize(member.normals_out * own) : own;
    }
    glm::dvec3 grain(const Hit& hit) override {
        const Member& member = members_[hit.object];
        const glm::dvec3 own = tracers_[hit.object]->grain(member.backIn(hit));
        if (!member.turned) return own;
        const glm::dvec3 placed = member.linear * own;
        const double length = glm::length(placed);
        return length > 0.0 ? placed / length : glm::dvec3(0.0);
    }
    std::optional<glm::vec3> attribute(const Hit& hit, std::size_t which) override {
        return tracers_[hit.object]->attribute(members_[hit.object].backIn(hit), which);
    }

private:
    // With a tree: the rays that meet the box of each member, sorted by member and ray with a counting sort.
    void listMet(std::span<const Ray> rays) {
        if (!tree_) return;
        met_.clear();
        ray_of_.clear();
        met_end_.assign(members_.size(), 0);
        for (std::uint32_t n = 0; n < rays.size(); ++n)
            tree_->visit(BoxTest(rays[n]), rays[n].t_max, [&](std::uint32_t m) {
                met_.push_back(m);
                ray_of_.push_back(n);
                ++met_end_[m];
                return false;
            });
        std::exclusive_scan(met_end_.begin(), met_end_.end(), met_end_.begin(), std::uint32_t{0});
        met_rays_.resize(met_.size());
        for (std::size_t k = 0; k < met_.size(); ++k) met_rays_[met_end_[met_[k]]++] = ray_of_[k];
    }

    // The rays that meet the box of member m before their `limit`; false if there are none.
    template <typename Limit>
    bool gather(std::uint32_t m, std::span<const Ray> rays, const Limit& limit) {
        own_.clear();
        places_.clear();
        stretches_.clear();
        const auto add = [&](std::size_t n) {
            Ray rest = rays[n];
            rest.t_max = std::min(rest.t_max, limit(n));
            if (!BoxTest(rest).meets(members_[m].box, rest.t_max)) return;
            double stretch = 1.0;
            own_.push_back(members_[m].inOwnSpace(rest, stretch));
            stretches_.push_back(stretch);
            places_.push_back(n);
        };
        if (tree_)
            for (std::uint32_t k = m == 0 ? 0 : met_end_[m - 1]; k < met_end_[m]; ++k) add(met_rays_[k]);
        else
            for (std::size_t n = 0; n < rays.size(); ++n) add(n);
        return !own_.empty();
    }

    const std::vector<Member>& members_;
    const std::optional<BoxTree>& tree_;
    std::vector<std::unique_ptr<Tracer>> tracers_;
    // The current stream: pairs of a member and a ray; rays sorted by member, and the end of each member's rays.
    std::vector<std::uint32_t> met_, ray_of_, met_rays_, met_end_;
    // Of the current member.
    std::vector<Ray> own_;
    std::vector<Hit> own_hits_;
    std::vector<std::uint8_t> own_blocked_;
    std::vector<double> stretches_;
    std::vector<std::size_t> places_;
};

class SceneIntersector final : public Intersector {
public:
    SceneIntersector(const std::vector<SceneObject>& objects, std::size_t many)
        : bounds_{glm::dvec3(kInfinity), glm::dvec3(-kInfinity)} {
        std::vector<const Intersector*> shapes;
        for (const SceneObject& object : objects) {
            Member member;
            member.shape = object.shape;
            member.box = boxOf(object);
            member.linear = object.placement.linear;
            member.offset = object.placement.offset;
            member.turned = member.linear != glm::dmat3(1.0);
            member.to_own = glm::inverse(member.linear);
            member.normals_out = glm::transpose(member.to_own);
            // Frobenius' norm bounds the longest image; for a rotation it is sqrt(3).
            double square = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const double length = glm::length(member.linear[axis]);
                if (!(std::abs(glm::determinant(member.linear)) > 0) || !std::isfinite(length) ||
                    !std::isfinite(glm::length(member.offset)))
                    throw UsageError(
                        fmt::format("object {}: its transform can't be undone; every scale must be a finite number "
                                    "other than 0",
                                    members_.all.size()));
                square += length * length;
            }
            if (member.turned) member.most_stretch = std::sqrt(square);
            if (hasEnd(member.box)) {
                bounds_.min = glm::min(bounds_.min, member.box.min);
                bounds_.max = glm::max(bounds_.max, member.box.max);
            }
            voxel_size_ = std::min(voxel_size_, member.shape->voxelSize() * member.most_stretch);
            offset_ = std::max(offset_, member.shape->surfaceOffset() * member.most_stretch);
            if (std::find(shapes.begin(), shapes.end(), member.shape.get()) == shapes.end()) {
                shapes.push_back(member.shape.get());
                bytes_ += member.shape->bytes();
                if (names_.find(member.shape->name()) == std::string::npos) {
                    if (!names_.empty()) names_.push_back('+');
                    names_ += member.shape->name();
                }
            }
            members_.all.push_back(std::move(member));
        }
        if (!(bounds_.min.x <= bounds_.max.x))
            throw UsageError("the scene has only endless shapes; add one that has an end, for the camera to look at");
        const double farthest = glm::length(glm::max(glm::abs(bounds_.min), glm::abs(bounds_.max)));
        offset_ = std::max(offset_, 4 * std::numeric_limits<double>::epsilon() * farthest);
        if (objects.size() < many) return;
        std::vector<Box> boxes;
        for (const Member& member : members_.all) boxes.push_back(member.box);
        bytes_ += members_.tree.emplace(boxes).bytes();
    }

    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<SceneTracer>(members_); }
    std::string_view name() const override { return names_; }
    Box bounds() const override { return bounds_; }
    double voxelSize() const override { return voxel_size_; }
    std::size_t bytes() const override { return bytes_; }
    // The largest offset of all objects.
    double surfaceOffset() const override { return offset_; }

private:
    Members members_;
    Box bounds_;
    double voxel_size_ = kInfinity;
    double offset_ = 0.0;
    std::size_t bytes_ = 0;
    std::string names_;
};

glm::dmat3 turn(int axis, double degrees) {
    // Right angles are exact, so that upright objects stay axis-aligned.
    double s = std::sin(degrees * std::numbers::pi / 180.0);
    double c = std::cos(degrees * std::numbers::pi / 180.0);
    if (const double quarters = degrees / 90.0; quarters == std::round(quarters)) {
        s = std::round(s);
        c = std::round(c);
    }
    glm::dmat3 m(1.0);
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    m[u][u] = c;
    m[u][v] = s;
    m[v][u] = -s;
    m[v][v] = c;
    return m;
}

}  // namespace

Placement Placement::of(const glm::dvec3& scale, const glm::dvec3& degrees, const glm::dvec3& offset) {
    glm::dmat3 m(1.0);
    for (int axis = 0; axis < 3; ++axis) m[axis][axis] = scale[axis];
    for (int axis = 0; axis < 3; ++axis) m = turn(axis, degrees[axis]) * m;
    return {m, offset};
}

bool Placement::isIdentity() const { return *this == Placement{}; }

std::shared_ptr<const Intersector> makeSceneIntersector(std::vector<SceneObject> objects, std::size_t many) {
    if (objects.empty()) throw UsageError("the scene has no objects; name at least one");
    if (objects.size() == 1 && objects.front().placement.isIdentity() && hasEnd(objects.front().shape->bounds()))
        return objects.front().shape;
    return std::make_shared<SceneIntersector>(objects, many);
}

}  // namespace stratum::trace
