// A print whose samples are computed when rays reach them.
#pragma once

#include "march/brick/brick_grid.h"
#include "ondemand/print_field.h"

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace stratum::assemble {

/// The print at one voxel size, and its bricks.
struct LazyLevel {
    std::shared_ptr<ondemand::PrintField> field;
    std::shared_ptr<march::BrickGrid> bricks;
};

/// Nothing here may be called while rays are traced.
class LazyPrint {
public:
    struct Times {
        double parse = 0;  ///< seconds, of reading the G-code
        double all = 0;    ///< seconds, of that and of all until it can be traced
    };

    /// @param levels       from the finest; at least one
    /// @param moments      of a growing print: the beads before this index are printed; ascending, the last one is all
    /// @param cache_bytes  bound on the samples of each level
    /// @param tips         mm in the world, by moment: where the nozzle is
    LazyPrint(std::vector<LazyLevel> levels, std::vector<std::uint32_t> moments, std::vector<glm::dvec3> tips,
              Times times, std::size_t cache_bytes);

    /// The number of moments of a growing print; 1 for others.
    std::size_t moments() const { return moments_.size(); }
    /// The beads before this index are printed at a moment.
    std::uint32_t beadsAt(std::size_t moment) const { return moments_[moment]; }
    /// Where the nozzle is at a moment, mm in the world: at the end of the last bead.
    const glm::dvec3& tipAt(std::size_t moment) const { return tips_[moment]; }
    /// Shows a moment, 0..moments() - 1. Bricks that don't change are kept.
    void show(std::size_t moment);

    /// The print at its finest voxel size.
    const ondemand::PrintField& finest() const { return *levels_.front().field; }

    /// Seconds, bricks and bytes so far.
    nlohmann::ordered_json report() const;

private:
    std::vector<LazyLevel> levels_;
    std::vector<std::uint32_t> moments_;
    std::vector<glm::dvec3> tips_;
    Times times_;
    std::size_t cache_bytes_;
};

}  // namespace stratum::assemble
