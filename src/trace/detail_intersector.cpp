#include "trace/detail_intersector.h"

#include "base/error.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

namespace stratum::trace {
namespace {

// Rays that are traced by several intersectors of one shape, each along one piece of the ray.
//
// The surfaces of two parts differ by up to half a voxel of each, so at the boundary between two pieces a ray may be
// outside of one part and inside of the other. The shape is then closed by a wall on the boundary, and a ray that meets
// the wall from outside has hit the shape: nothing leaks. A ray that begins in the solid may leave through a wall
// undetected.

/// The pieces of one ray and their parts: piece n goes from the end of piece n - 1 to ends[n].
struct Pieces {
    /// Enough for eight nested parts, each entered and left.
    static constexpr std::size_t kMost = 15;
    std::array<double, kMost> ends;  ///< ascending, the last one is the ray's t_max
    std::array<std::uint8_t, kMost> parts;
    std::uint32_t count = 0;
};

constexpr std::size_t kMostLevels = (Pieces::kMost + 1) / 2;

/// Cuts a ray at spheres around the eye: at least one piece, even for a ray without a length.
class SphereCutter {
public:
    SphereCutter(const glm::dvec3& eye, std::vector<double> radii) : eye_(eye), radii_(std::move(radii)) {}

    void cut(const Ray& ray, Pieces& pieces) const {
        pieces.count = 0;
        const glm::dvec3 to_eye = eye_ - ray.origin;
        const double nearest = glm::dot(to_eye, ray.direction);
        const double miss = glm::length(to_eye - nearest * ray.direction);
        double begin = ray.t_min;
        // Intersections outside the ray's interval are skipped.
        const auto add = [&](std::size_t part, double end) {
            if (!(end > begin) || !(begin < ray.t_max)) return;
            begin = end = std::min(end, ray.t_max);
            pieces.ends[pieces.count] = end;
            pieces.parts[pieces.count] = static_cast<std::uint8_t>(part);
            ++pieces.count;
        };
        // Half of the chord. Every operation is monotonic in the radius, even when rounded, so the positions ascend.
        const auto half = [miss](double radius) { return std::sqrt((radius - miss) * (radius + miss)); };
        std::size_t part = radii_.size();
        for (; part > 0 && miss < radii_[part - 1]; --part) add(part, nearest - half(radii_[part - 1]));
        for (; part < radii_.size(); ++part) add(part, nearest + half(radii_[part]));
        if (pieces.count == 0 || begin < ray.t_max) {
            pieces.ends[pieces.count] = ray.t_max;
            pieces.parts[pieces.count] = static_cast<std::uint8_t>(part);
            ++pieces.count;
        }
    }

private:
    const glm::dvec3 eye_;
    const std::vector<double> radii_;  // boundaries between part n and part n + 1
};

// Whether the ray leaves the solid at this hit.
bool leaves(const Ray& ray, const Hit& hit) { return glm::dot(hit.normal, ray.direction) > 0; }

// The reversed ray, from the beginning of a piece to the ray's own beginning.
Ray backFrom(double begin, const Ray& ray) {
    Ray back;
    back.origin = ray.origin + begin * ray.direction;
    back.direction = -ray.direction;
    back.t_max = begin - ray.t_min;
    return back;
}

// From the beginning of a piece to the next hit of the previous part: out of the solid, if the ray is inside of that
// part there. Only the direction of the crossing is used, so that part need not be valid beyond its own piece.
Ray aheadFrom(double begin, const Ray& ray) {
    Ray ahead = ray;
    ahead.t_min = begin;
    ahead.t_max = kInfinity;
    return ahead;
}

// The hit of a ray that met a wall at the beginning of a piece. The ray is inside of this part there, and outside of
// the previous part, so it entered this part before, at `back`. The hit is at that position, not on the wall: it is on
// this part's surface and outside of the previous part, so secondary rays from it are not blocked, while a point on the
// wall would be below the surface that continues behind it.
Hit wallHit(const Ray& ray, double begin, const Hit& back) {
    Hit hit = back;
    hit.t = begin - back.t;
    hit.position = ray.origin + hit.t * ray.direction;
    return hit;
}

/// The nearest hit is that of the first piece that has one. Hit::part is the part, which has the attributes and normals
/// of the hit. Streams are passed on to the parts as streams: all rays whose current piece has the same part, together.
class PiecewiseTracer final : public Tracer {
public:
    /// The intersectors and the cutter must outlive it. No more than 256 parts.
    PiecewiseTracer(std::span<const std::shared_ptr<const Intersector>> parts, const SphereCutter& cutter)
        : cutter_(cutter) {
        for (const auto& part : parts) tracers_.push_back(part->makeTracer());
    }

    bool intersect(const Ray& ray, Hit& hit) override {
        Way way;
        for (cutter_.cut(ray, way.pieces);; ++way.at) {
            Tracer& tracer = *tracers_[way.part()];
            Hit found;
            const bool any = tracer.intersect(way.piece(ray), found);
            bool done = any;
            if (wantsLookBack(ray, way, any ? &found : nullptr)) {
                Hit back;
                Hit ahead;
                const double begin = way.begin(ray);
                if (tracer.intersect(backFrom(begin, ray), back) && !leaves(ray, back) &&
                    !(tracers_[way.before()]->intersect(aheadFrom(begin, ray), ahead) && leaves(ray, ahead))) {
                    found = wallHit(ray, begin, back);
                    done = true;
                }
            }
            if (done) {
                hit = marked(found, way.part());
                return true;
            }
            if (way.last()) return false;
        }
    }
    /// Any crossing in any piece. Walls don't occlude: the entry and the exit of a ray that meets nothing but walls are
    /// within the parts' error of each other.
    bool occluded(const Ray& ray) override {
        Way way;
        for (cutter_.cut(ray, way.pieces);; ++way.at) {
            if (tracers_[way.part()]->occluded(way.piece(ray))) return true;
            if (way.last()) return false;
        }
    }
    void intersectStream(std::span<const Ray> rays, std::span<Hit> hits) override {
        for (Hit& hit : hits) hit.t = kInfinity;
        for (cutAll(rays); !waiting_.empty(); goOn()) {
            for (std::size_t part = 0; part < tracers_.size(); ++part) {
                gather(part, rays);
                if (own_.empty()) continue;
                own_hits_.assign(own_.size(), Hit{});
                tracers_[part]->intersectStream(own_, own_hits_);
                lookBack(part, rays);
                for (std::size_t k = 0; k < places_.size(); ++k)
                    if (std::isfinite(own_hits_[k].t)) hits[places_[k]] = marked(own_hits_[k], part);
            }
            std::erase_if(waiting_, [&hits](std::uint32_t n) { return std::isfinite(hits[n].t); });
        }
    }
    void occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) override {
        std::fill(blocked.begin(), blocked.end(), std::uint8_t{0});
        for (cutAll(rays); !waiting_.empty(); goOn()) {
            for (std::size_t part = 0; part < tracers_.size(); ++part) {
                gather(part, rays);
                if (own_.empty()) continue;
                own_blocked_.assign(own_.size(), 0);
                tracers_[part]->occludedStream(own_, own_blocked_);
                for (std::size_t k = 0; k < places_.size(); ++k) blocked[places_[k]] = own_blocked_[k];
            }
            std::erase_if(waiting_, [&blocked](std::uint32_t n) { return blocked[n] != 0; });
        }
    }
    glm::dvec3 shadingNormal(const Hit& hit) override {
        return tracers_[hit.part % tracers_.size()]->shadingNormal(own(hit));
    }
    glm::dvec3 grain(const Hit& hit) override { return tracers_[hit.part % tracers_.size()]->grain(own(hit)); }
    std::optional<glm::vec3> attribute(const Hit& hit, std::size_t which) override {
        return tracers_[hit.part % tracers_.size()]->attribute(own(hit), which);
    }

private:
    struct Way {
        Pieces pieces;
        std::uint32_t at = 0;  // the current piece

        std::uint8_t part() const { return pieces.parts[at]; }
        /// Not of the first piece.
        std::uint8_t before() const { return pieces.parts[at - 1]; }
        bool last() const { return at + 1 == pieces.count; }
        double begin(const Ray& ray) const { return at == 0 ? ray.t_min : pieces.ends[at - 1]; }
        Ray piece(const Ray& ray) const {
            Ray piece = ray;
            piece.t_min = begin(ray);
            piece.t_max = pieces.ends[at];
            return piece;
        }
    };
    // If the ray is outside at the beginning of a piece (not the first), its first crossing is an entry, or there is
    // none. So whether it is inside must be tested only if the first crossing is an exit, or if the piece has no
    // crossing.
    bool wantsLookBack(const Ray& ray, const Way& way, const Hit* found) const {
        if (way.at == 0) return false;
        return found != nullptr ? leaves(ray, *found) : std::isfinite(way.pieces.ends[way.at]);
    }
    void cutAll(std::span<const Ray> rays) {
        ways_.resize(rays.size());
        for (std::size_t n = 0; n < rays.size(); ++n) {
            cutter_.cut(rays[n], ways_[n].pieces);
            ways_[n].at = 0;
        }
        waiting_.resize(rays.size());
        std::iota(waiting_.begin(), waiting_.end(), 0U);
    }
    void gather(std::size_t part, std::span<const Ray> rays) {
        own_.clear();
        places_.clear();
        for (const std::uint32_t n : waiting_) {
            if (ways_[n].part() != part) continue;
            places_.push_back(n);
            own_.push_back(ways_[n].piece(rays[n]));
        }
    }
    // Rays of the current part that may be behind a wall.
    void lookBack(std::size_t part, std::span<const Ray> rays) {
        back_.clear();
        back_places_.clear();
        for (std::size_t k = 0; k < places_.size(); ++k) {
            const std::uint32_t n = places_[k];
            if (!wantsLookBack(rays[n], ways_[n], std::isfinite(own_hits_[k].t) ? &own_hits_[k] : nullptr)) continue;
            back_places_.push_back(static_cast<std::uint32_t>(k));
            back_.push_back(backFrom(ways_[n].begin(rays[n]), rays[n]));
        }
        if (back_.empty()) return;
        back_hits_.assign(back_.size(), Hit{});
        tracers_[part]->intersectStream(back_, back_hits_);
        // Rays with an entry may have begun inside of the previous part.
        const auto rayOf = [&](std::size_t b) { return places_[back_places_[b]]; };
        for (std::size_t before = 0; before < tracers_.size(); ++before) {
            ahead_.clear();
            ahead_places_.clear();
            for (std::size_t b = 0; b < back_.size(); ++b) {
                const std::uint32_t n = rayOf(b);
                if (ways_[n].before() != before || !std::isfinite(back_hits_[b].t) || leaves(rays[n], back_hits_[b]))
                    continue;
                ahead_places_.push_back(static_cast<std::uint32_t>(b));
                ahead_.push_back(aheadFrom(ways_[n].begin(rays[n]), rays[n]));
            }
            if (ahead_.empty()) continue;
            ahead_hits_.assign(ahead_.size(), Hit{});
            tracers_[before]->intersectStream(ahead_, ahead_hits_);
            for (std::size_t a = 0; a < ahead_.size(); ++a) {
                const std::uint32_t b = ahead_places_[a];
                const std::uint32_t n = rayOf(b);
                if (std::isfinite(ahead_hits_[a].t) && leaves(rays[n], ahead_hits_[a])) continue;
                own_hits_[back_places_[b]] = wallHit(rays[n], ways_[n].begin(rays[n]), back_hits_[b]);
            }
        }
    }
    // Advances each ray without a result to its next piece, if it has one.
    void goOn() {
        std::erase_if(waiting_, [this](std::uint32_t n) { return ways_[n].last(); });
        for (const std::uint32_t n : waiting_) ++ways_[n].at;
    }
    Hit marked(Hit hit, std::size_t part) const {
        // If the part is composite itself, its own Hit::part is kept.
        hit.part = static_cast<std::uint32_t>(hit.part * tracers_.size() + part);
        return hit;
    }
    Hit own(const Hit& hit) const {
        Hit own = hit;
        own.part = static_cast<std::uint32_t>(hit.part / tracers_.size());
        return own;
    }

    std::vector<std::unique_ptr<Tracer>> tracers_;
    const SphereCutter& cutter_;
    // The current stream; members, because allocating them for every stream would cost as much as tracing it.
    std::vector<Way> ways_;
    std::vector<std::uint32_t> waiting_;  // rays without a result, ascending
    // The rays of the current part, and their indices.
    std::vector<std::uint32_t> places_, back_places_, ahead_places_;
    std::vector<Ray> own_, back_, ahead_;
    std::vector<Hit> own_hits_, back_hits_, ahead_hits_;
    std::vector<std::uint8_t> own_blocked_;
};

class DetailIntersector final : public Intersector {
public:
    DetailIntersector(std::vector<DetailLevel> levels, const glm::dvec3& eye) : cutter_(eye, radiiOf(levels)) {
        for (DetailLevel& level : levels) parts_.push_back(std::move(level.shape));
    }

    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<PiecewiseTracer>(parts_, cutter_); }
    std::string_view name() const override { return parts_.front()->name(); }
    Box bounds() const override {
        Box all = parts_.front()->bounds();
        for (const auto& part : parts_) {
            all.min = glm::min(all.min, part->bounds().min);
            all.max = glm::max(all.max, part->bounds().max);
        }
        return all;
    }
    double voxelSize() const override { return parts_.front()->voxelSize(); }
    std::size_t bytes() const override {
        std::size_t sum = 0;
        for (const auto& part : parts_) sum += part->bytes();
        return sum;
    }
    double surfaceOffset() const override { return parts_.back()->surfaceOffset(); }

private:
    static std::vector<double> radiiOf(const std::vector<DetailLevel>& levels) {
        std::vector<double> radii;
        for (std::size_t n = 1; n < levels.size(); ++n) radii.push_back(levels[n].from);
        return radii;
    }

    std::vector<std::shared_ptr<const Intersector>> parts_;
    const SphereCutter cutter_;
};

}  // namespace

std::shared_ptr<const Intersector> makeDetailIntersector(std::vector<DetailLevel> levels, const glm::dvec3& eye) {
    if (levels.empty() || levels.size() > kMostLevels)
        throw UsageError(fmt::format("{} levels of detail: expected 1 to {}", levels.size(), kMostLevels));
    if (levels.front().from != 0) throw UsageError("levels of detail: the first one must begin at the eye");
    for (std::size_t n = 1; n < levels.size(); ++n)
        if (!(levels[n].from > levels[n - 1].from && std::isfinite(levels[n].from)))
            throw UsageError("levels of detail: distances must ascend");
    if (levels.size() == 1) return std::move(levels.front().shape);
    return std::make_shared<DetailIntersector>(std::move(levels), eye);
}

}  // namespace stratum::trace
