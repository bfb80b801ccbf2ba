// Which bead a place of a print belongs to.
#pragma once

#include "ondemand/print_field.h"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace stratum::ondemand {

/// Belongs to one thread, and caches a few recent leaves. The field must outlive it.
class BeadLookup {
public:
    explicit BeadLookup(const PrintField& field);

    /// The index of the bead whose surface is nearest to the nearest voxel of the eight around a point in the field's
    /// world space, of those that are active or inside the print, however deep; nothing where all are outside.
    std::optional<std::uint32_t> at(const glm::dvec3& position);

private:
    // Not initialized: most leaves of the cache are never used.
    struct Owned {
        std::array<std::uint64_t, voxelize::Leaf::NodeMaskType::WORD_COUNT> outside;  // at the background
        std::array<std::uint32_t, voxelize::Leaf::SIZE> rank;
    };
    std::optional<std::uint32_t> ownerOf(const openvdb::Coord& voxel);
    void fill(std::size_t place, const openvdb::Coord& origin);

    static constexpr std::size_t kSide = 16;
    const PrintField& field_;
    const openvdb::math::MapBase::ConstPtr map_;
    std::vector<openvdb::Coord> origins_ = std::vector<openvdb::Coord>(kSide * kSide * kSide, openvdb::Coord::max());
    std::unique_ptr<Owned[]> cache_ = std::make_unique_for_overwrite<Owned[]>(kSide * kSide * kSide);
};

}  // namespace stratum::ondemand
