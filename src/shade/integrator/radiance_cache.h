// What light paths deep in a translucent print bring on the mean, by place, direction and side of the surface.
#pragma once

#include "shade/brdf/rough_interface.h"
#include "shade/color.h"
#include "trace/intersector.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace stratum::shade {

/// A vertex of a path that was followed to its end.
struct DeepVertex {
    std::uint32_t cell = 0;  ///< RadianceCache::cell()
    std::uint32_t path = 0;
    Color throughput{0.0f};  ///< of the path up to here
    Color light{0.0f};       ///< what the path brings from here on, times `throughput`
};

/// A path that has met several surfaces of translucent solids comes from anywhere and goes anywhere: what it brings
/// from there on varies little with place and direction, and much from path to path. The cache has its mean, in cubes,
/// for six directions and the two sides of the surface, of paths from the same camera. So pictures are far less noisy
/// and soon done; what is lost is detail of deep light within a cell. The idea is that of Ward, Rubinstein, Clear, "A
/// Ray Tracing Solution for Diffuse Interreflection", SIGGRAPH 1988, with the radiance of surfaces inside as what is
/// cached. Immutable once it is made; shared by all threads.
class RadianceCache {
public:
    /// @param bounds  of the print, world space
    /// @param cells   along its longest side
    RadianceCache(const trace::Box& bounds, int cells);

    /// Adds the paths of one call; the bits depend on the order of calls.
    void add(std::span<const DeepVertex> vertices, std::size_t paths);

    /// @param direction  of the ray that has met a surface at `position`, unit
    /// @param side       that it came through
    std::uint32_t cell(const glm::dvec3& position, const glm::dvec3& direction, Side side) const;
    /// The same for a position that is drawn about it, so that cells fade into each other.
    /// @param u  each in [0, 1)
    std::uint32_t cellNear(const glm::dvec3& position, const glm::dvec3& direction, Side side,
                           const glm::dvec3& u) const {
        return cell(position + size_ * (u - 0.5), direction, side);
    }
    /// Nothing where too few paths came by.
    std::optional<Color> radiance(std::uint32_t cell) const;

    std::size_t paths() const { return paths_; }
    std::size_t vertices() const { return vertices_; }
    /// Cells that have a radiance.
    std::size_t known() const;
    std::size_t bytes() const { return entries_.size() * sizeof(Entry); }

private:
    struct Entry {
        Color light{0.0f}, throughput{0.0f};
        std::uint32_t count = 0;
    };
    glm::dvec3 low_;
    double size_;  // of a cell, world units
    std::array<std::uint32_t, 3> cells_;
    std::vector<Entry> entries_;
    std::size_t paths_ = 0, vertices_ = 0;
};

}  // namespace stratum::shade
