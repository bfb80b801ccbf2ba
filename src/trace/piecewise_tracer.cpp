#include "trace/piecewise_tracer.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace stratum::trace {
namespace {

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

}  // namespace

PiecewiseTracer::PiecewiseTracer(std::span<const std::shared_ptr<const Intersector>> parts, const RayCutter& cutter)
    : cutter_(cutter) {
    for (const auto& part : parts) tracers_.push_back(part->makeTracer());
}

Ray PiecewiseTracer::Way::piece(const Ray& ray) const {
    Ray piece = ray;
    piece.t_min = begin(ray);
    piece.t_max = pieces.ends[at];
    return piece;
}

// If the ray is outside at the beginning of a piece (not the first), its first crossing is an entry, or there is none.
// So whether it is inside must be tested only if the first crossing is an exit, or if the piece has no crossing.
bool PiecewiseTracer::wantsLookBack(const Ray& ray, const Way& way, const Hit* found) const {
    if (way.at == 0) return false;
    return found != nullptr ? leaves(ray, *found) : std::isfinite(way.pieces.ends[way.at]);
}

Hit PiecewiseTracer::marked(Hit hit, std::size_t part) const {
    // If the part is composite itself, its own Hit::part is kept.
    hit.part = static_cast<std::uint32_t>(hit.part * tracers_.size() + part);
    return hit;
}

Hit PiecewiseTracer::own(const Hit& hit) const {
    Hit own = hit;
    own.part = static_cast<std::uint32_t>(hit.part / tracers_.size());
    return own;
}

bool PiecewiseTracer::intersect(const Ray& ray, Hit& hit) {
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

bool PiecewiseTracer::occluded(const Ray& ray) {
    Way way;
    for (cutter_.cut(ray, way.pieces);; ++way.at) {
        if (tracers_[way.part()]->occluded(way.piece(ray))) return true;
        if (way.last()) return false;
    }
}

void PiecewiseTracer::cutAll(std::span<const Ray> rays) {
    ways_.resize(rays.size());
    for (std::size_t n = 0; n < rays.size(); ++n) {
        cutter_.cut(rays[n], ways_[n].pieces);
        ways_[n].at = 0;
    }
    waiting_.resize(rays.size());
    std::iota(waiting_.begin(), waiting_.end(), 0U);
}

void PiecewiseTracer::gather(std::size_t part, std::span<const Ray> rays) {
    own_.clear();
    places_.clear();
    for (const std::uint32_t n : waiting_) {
        if (ways_[n].part() != part) continue;
        places_.push_back(n);
        own_.push_back(ways_[n].piece(rays[n]));
    }
}

// Rays of the current part that may be behind a wall.
void PiecewiseTracer::lookBack(std::size_t part, std::span<const Ray> rays) {
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
void PiecewiseTracer::goOn() {
    std::erase_if(waiting_, [this](std::uint32_t n) { return ways_[n].last(); });
    for (const std::uint32_t n : waiting_) ++ways_[n].at;
}

void PiecewiseTracer::intersectStream(std::span<const Ray> rays, std::span<Hit> hits) {
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

void PiecewiseTracer::occludedStream(std::span<const Ray> rays, std::span<std::uint8_t> blocked) {
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

glm::dvec3 PiecewiseTracer::shadingNormal(const Hit& hit) {
    return tracers_[hit.part % tracers_.size()]->shadingNormal(own(hit));
}

glm::dvec3 PiecewiseTracer::grain(const Hit& hit) { return tracers_[hit.part % tracers_.size()]->grain(own(hit)); }

std::optional<glm::vec3> PiecewiseTracer::attribute(const Hit& hit, std::size_t which) {
    return tracers_[hit.part % tracers_.size()]->attribute(own(hit), which);
}

}  // namespace stratum::trace
