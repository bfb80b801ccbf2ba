#include "march/wide_intersector.h"

#include "march/piecewise_tracer.h"

#include <algorithm>
#include <array>
#include <utility>

namespace stratum::march {
namespace {

class DistanceCutter final : public RayCutter {
public:
    explicit DistanceCutter(double distance) : distance_(distance) {}

    void cut(const Ray& ray, Pieces& pieces) const override {
        pieces.count = 0;
        const auto add = [&pieces](std::uint8_t part, double end) {
            pieces.ends[pieces.count] = end;
            pieces.parts[pieces.count] = part;
            ++pieces.count;
        };
        if (!ray.wide) return add(0, ray.t_max);
        if (ray.t_min < distance_) add(0, std::min(distance_, ray.t_max));
        if (pieces.count == 0 || distance_ < ray.t_max) add(1, ray.t_max);
    }

private:
    const double distance_;
};

class WideIntersector final : public Intersector {
public:
    WideIntersector(std::shared_ptr<const Intersector> fine, std::shared_ptr<const Intersector> coarse, double distance)
        : parts_{std::move(fine), std::move(coarse)}, cutter_(distance) {}

    std::unique_ptr<Tracer> makeTracer() const override { return std::make_unique<PiecewiseTracer>(parts_, cutter_); }
    std::string_view name() const override { return parts_[0]->name(); }
    Box bounds() const override { return parts_[0]->bounds(); }
    double voxelSize() const override { return parts_[0]->voxelSize(); }
    double surfaceOffset() const override { return parts_[0]->surfaceOffset(); }
    std::size_t bytes() const override { return parts_[0]->bytes() + parts_[1]->bytes(); }

private:
    std::array<std::shared_ptr<const Intersector>, 2> parts_;
    const DistanceCutter cutter_;
};

}  // namespace

std::shared_ptr<const Intersector> makeWideIntersector(std::shared_ptr<const Intersector> fine,
                                                       std::shared_ptr<const Intersector> coarse, double distance) {
    return std::make_shared<WideIntersector>(std::move(fine), std::move(coarse), distance);
}

}  // namespace stratum::march
