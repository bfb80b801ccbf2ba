#include "shade/integrator/radiance_cache.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::shade {
namespace {

constexpr std::uint32_t kSides = 2, kDirections = 6;
/// The mean of fewer vertices may be far off.
constexpr std::uint32_t kFewest = 16;

}  // namespace

RadianceCache::RadianceCache(const trace::Box& bounds, int cells) : low_(bounds.min), size_(1.0), cells_{1, 1, 1} {
    const glm::dvec3 extent = bounds.max - bounds.min;
    const double longest = std::max({extent.x, extent.y, extent.z});
    if (longest > 0.0 && std::isfinite(longest)) {
        size_ = longest / cells;
        for (int axis = 0; axis < 3; ++axis)
            cells_[static_cast<std::size_t>(axis)] = static_cast<std::uint32_t>(
                std::clamp(std::ceil(extent[axis] / size_), 1.0, static_cast<double>(cells)));
    }
    entries_.resize(std::size_t{cells_[0]} * cells_[1] * cells_[2] * kDirections * kSides);
}

void RadianceCache::add(std::span<const DeepVertex> vertices, std::size_t paths) {
    paths_ += paths;
    vertices_ += vertices.size();
    for (const DeepVertex& vertex : vertices) {
        Entry& entry = entries_[vertex.cell];
        entry.light += vertex.light;
        entry.throughput += vertex.throughput;
        entry.count += entry.count < std::numeric_limits<std::uint32_t>::max() ? 1 : 0;
    }
}

std::uint32_t RadianceCache::cell(const glm::dvec3& position, const glm::dvec3& direction, Side side) const {
    std::uint32_t at = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const std::uint32_t count = cells_[static_cast<std::size_t>(axis)];
        const double place = (position[axis] - low_[axis]) / size_;
        at = at * count + static_cast<std::uint32_t>(std::clamp(place, 0.0, count - 1.0));
    }
    int along = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (std::abs(direction[axis]) > std::abs(direction[along])) along = axis;
    const std::uint32_t towards = 2 * static_cast<std::uint32_t>(along) + (direction[along] > 0.0 ? 1 : 0);
    return (at * kDirections + towards) * kSides + (side == Side::solid ? 1 : 0);
}

std::optional<Color> RadianceCache::radiance(std::uint32_t cell) const {
    const Entry& entry = entries_[cell];
    if (entry.count < kFewest) return std::nullopt;
    Color mean(0.0f);
    for (int c = 0; c < 3; ++c)
        if (entry.throughput[c] > 0.0f) mean[c] = entry.light[c] / entry.throughput[c];
    return mean;
}

std::size_t RadianceCache::known() const {
    return static_cast<std::size_t>(
        std::count_if(entries_.begin(), entries_.end(), [](const Entry& entry) { return entry.count >= kFewest; }));
}

}  // namespace stratum::shade
