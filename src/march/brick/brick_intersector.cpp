#include "march/brick/brick_intersector.h"

#include "march/brick/brick_stream.h"
#include "march/brick/brick_walk.h"
#include "march/file/grid_axes.h"
#include "march/file/level_set_file.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace stratum::march {
namespace {

class BrickTracer final : public trace::Tracer {
public:
    BrickTracer(const BrickGrid& grid, const CellMap& map) : grid_(grid), map_(map) {}

    bool intersect(const trace::Ray& ray, trace::Hit& hit) override { return trace(ray, &hit); }
    bool occluded(const trace::Ray& ray) override { return trace(ray, nullptr); }
    void intersectStream(std::span<const trace::Ray> rays, std::span<trace::Hit> hits) override {
        if (!streamIntersect(grid_, map_, rays, hits)) trace::Tracer::intersectStream(rays, hits);
    }
    void occludedStream(std::span<const trace::Ray> rays, std::span<std::uint8_t> blocked) override {
        if (!streamOccluded(grid_, map_, rays, blocked)) trace::Tracer::occludedStream(rays, blocked);
    }

private:
    // With `hit` the nearest root is refined; without, the first sign change is enough.
    bool trace(const trace::Ray& ray, trace::Hit* hit) const {
        const BrickSlots::Reading reading(grid_.cache());
        Walk walk(map_.to_cells * ray.origin + map_.origin, map_.to_cells * ray.direction);
        if (!walk.enter(ray.t_min, ray.t_max, grid_.size())) return false;
        while (true) {
            const Block block = findBlock(grid_, walk.cell(), walk.octant());
            walk.aim(block.low, block.high);
            if (block.surface) {
                const Corners corners = cornersOf(grid_, block.brick, walk.cell());
                const glm::dvec3 from = walk.localEntry();
                const glm::dvec3 to = walk.localExit();
                const SegmentCubic field(corners, from, to);
                if (const auto bracket = firstCrossing(field)) {
                    if (hit != nullptr) report(ray, walk, corners, from, to, refineRoot(field, *bracket), *hit);
                    return true;
                }
            }
            if (!walk.advance(block.low, block.high, grid_.size())) return false;
        }
    }

    void report(const trace::Ray& ray, const Walk& walk, const Corners& corners, const glm::dvec3& from,
                const glm::dvec3& to, double s, trace::Hit& hit) const {
        hit.t = walk.at(s);
        hit.position = ray.origin + hit.t * ray.direction;
        // Gradients transform by the transpose of the map to cells.
        const glm::dvec3 normal = gradient(corners, from + s * (to - from)) * map_.to_cells;
        const double length = glm::length(normal);
        // A gradient that vanishes gives no direction; facing the ray keeps everything downstream finite.
        hit.normal = length > 0 ? normal / length : -ray.direction;
    }

    const BrickGrid& grid_;
    const CellMap& map_;
};

class BrickIntersector final : public trace::Intersector {
public:
    BrickIntersector(const openvdb::FloatGrid& grid, BrickValues values)
        : bricks_(grid, values),
          map_(*grid.transform().baseMap(), bricks_.origin()),
          bounds_(narrowBandBounds(grid)),
          voxel_size_(GridAxes(grid.transform()).shortest()) {}
    // `bricks` makes the BrickGrid.
    template <typename... Bricks>
    BrickIntersector(const LeafFile& file, Bricks&&... bricks)
        : bricks_(std::forward<Bricks>(bricks)...),
          map_(*file.head().transform().baseMap(), bricks_.origin()),
          bounds_(worldBounds(file.head().transform(), file.activeBox())),
          voxel_size_(GridAxes(file.head().transform()).shortest()) {}
    BrickIntersector(const LeafField& field, std::shared_ptr<const LeafField> owned, BrickValues values,
                     std::size_t cache_bytes)
        : bricks_(std::move(owned), values, cache_bytes),
          map_(*field.transform().baseMap(), bricks_.origin()),
          bounds_(worldBounds(field.transform(), field.activeBox())),
          voxel_size_(GridAxes(field.transform()).shortest()) {}

    std::unique_ptr<trace::Tracer> makeTracer() const override { return std::make_unique<BrickTracer>(bricks_, map_); }
    std::string_view name() const override { return "brick"; }
    trace::Box bounds() const override { return bounds_; }
    double voxelSize() const override { return voxel_size_; }
    // Hits are exact, so a thousandth of a voxel clears the surface, unless the coordinates themselves are rounded more
    // coarsely than that.
    double surfaceOffset() const override {
        const double farthest = glm::length(glm::max(glm::abs(bounds_.min), glm::abs(bounds_.max)));
        return std::max(1e-3 * voxel_size_, 4 * std::numeric_limits<double>::epsilon() * farthest);
    }
    std::size_t bytes() const override { return bricks_.bytes(); }
    BrickGrid& bricks() { return bricks_; }

private:
    BrickGrid bricks_;
    CellMap map_;
    trace::Box bounds_;
    double voxel_size_;
};

}  // namespace

std::unique_ptr<trace::Intersector> makeBrickIntersector(const openvdb::FloatGrid& grid, BrickValues values) {
    requireTraceable(grid, grid.getName());
    return std::make_unique<BrickIntersector>(grid, values);
}

std::unique_ptr<trace::Intersector> makeBrickIntersector(std::shared_ptr<const LeafFile> file, BrickValues values,
                                                         std::size_t cache_bytes) {
    // About 10 ms to read: worth it, for then damage shows before the picture begins, and empty bricks are known.
    constexpr std::size_t kSmall = 4096;
    const LeafFile& leaves = *file;
    if (leaves.leafCount() < kSmall) return std::make_unique<BrickIntersector>(leaves, leaves, values);
    return std::make_unique<BrickIntersector>(leaves, std::move(file), values, cache_bytes);
}

std::unique_ptr<trace::Intersector> makeBrickIntersector(std::shared_ptr<const LeafField> field, BrickValues values,
                                                         std::size_t cache_bytes) {
    const LeafField& leaves = *field;
    return std::make_unique<BrickIntersector>(leaves, std::move(field), values, cache_bytes);
}

TracedBricks makeTracedBricks(std::shared_ptr<const LeafField> field, BrickValues values, std::size_t cache_bytes) {
    const LeafField& leaves = *field;
    const auto made = std::make_shared<BrickIntersector>(leaves, std::move(field), values, cache_bytes);
    return {made, std::shared_ptr<BrickGrid>(made, &made->bricks())};
}

}  // namespace stratum::march
