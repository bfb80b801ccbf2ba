#include "trace/detail_intersector.h"

#include "base/error.h"
#include "trace/piecewise_tracer.h"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::trace {
namespace {

constexpr std::size_t kMostLevels = (Pieces::kMost + 1) / 2;

// Cuts a ray at spheres around the eye.
class SphereCutter final : public RayCutter {
public:
    SphereCutter(const glm::dvec3& eye, std::vector<double> radii) : eye_(eye), radii_(std::move(radii)) {}

    void cut(const Ray& ray, Pieces& pieces) const override {
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
