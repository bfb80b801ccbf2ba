// A print whose samples are made when rays come to them.
#pragma once

#include "march/brick/brick_grid.h"
#include "ondemand/print_field.h"
#include "shade/film/picture.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
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
        double all = 0;    ///< seconds, of that and of all until rays may come
    };

    /// @param levels       from the finest; at least one
    /// @param moments      of a growing print: what lies before these beads is printed; ascending, the last one is all
    /// @param cache_bytes  of samples that each level may keep at once
    LazyPrint(std::vector<LazyLevel> levels, std::vector<std::uint32_t> moments, Times times, std::size_t cache_bytes);

    /// How many pictures a growing print makes; 1 for others.
    std::size_t moments() const { return moments_.size(); }
    /// Brings the print to a moment, 0..moments() - 1. What was made before is kept where it stays the same.
    void show(std::size_t moment);

    /// What it took so far: seconds, bricks, bytes.
    nlohmann::ordered_json report() const;

    /// Which bricks rays came to, see assemble::writeBrickPicture(). Of several levels: a file each, numbered from the
    /// finest. Throws UsageError, OutputError.
    void writeBrickPicture(const std::string& path, const shade::Metadata& metadata) const;

private:
    std::vector<LazyLevel> levels_;
    std::vector<std::uint32_t> moments_;
    Times times_;
    std::size_t cache_bytes_;
};

}  // namespace stratum::assemble
