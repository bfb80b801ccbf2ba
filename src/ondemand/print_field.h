// Toolpath -> a level set that is sampled on demand, for pictures without a grid.
#pragma once

#include "base/stopwatch.h"
#include "gcode/toolpath/toolpath.h"
#include "march/file/leaf_field.h"
#include "ondemand/brick_map.h"
#include "ondemand/print_layout.h"
#include "voxelize/beads/placement.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace stratum::ondemand {

/// Durations of its construction, for reports.
struct PrintFieldTimes {
    double bins = 0;  ///< seconds: layers and plan bins
    double box = 0;   ///< seconds: the box of the active voxels
    double map = 0;   ///< seconds: the map of the bricks
};

class PrintField final : public march::LeafField {
public:
    /// `selection`: indices into toolpath->beads, ascending, not empty. The samples are, bit for bit, those of
    /// voxelize::voxelize() with Interior::keep. Throws UsageError for what does not fit.
    PrintField(std::shared_ptr<const gcode::Toolpath> toolpath, std::span<const std::uint32_t> selection,
               const voxelize::Lattice& lattice, const voxelize::Placement& placement, std::string name);
    ~PrintField() override;
    PrintField(const PrintField&) = delete;
    PrintField& operator=(const PrintField&) = delete;

    /// Sets the print to the selected beads before index `end` of the toolpath, and returns the leaves whose samples
    /// may have changed: ascending, each once. Its box and its map of bricks stay those of the whole selection. Not
    /// while rays are traced; see march::BrickGrid::update().
    std::vector<openvdb::Coord> printUntil(std::uint32_t end);
    std::uint32_t printed() const { return end_; }

    const march::BrickMap& bricks() const override { return map_.bricks; }
    bool shows(std::size_t macro) const override { return map_.first_bead[macro] < end_; }
    bool samples(const openvdb::Coord& origin, march::FieldSamples& out) const override;
    float background() const override { return background_; }
    double signSlack() const override { return sign_slack_; }
    const openvdb::math::Transform& transform() const override { return *transform_; }
    openvdb::CoordBBox activeBox() const override { return active_; }
    std::string name() const override { return name_; }
    std::size_t bytes() const override;

    const PrintLayout& layout() const { return layout_; }
    /// What the calling thread makes samples() with: it keeps what leaves nearby need too.
    LeafMaker& maker() const;
    const PrintFieldTimes& times() const { return times_; }
    /// Leaves evaluated so far, by all threads. Not while rays are traced.
    std::size_t leavesMade() const;

private:
    struct Threads;

    const openvdb::math::Transform::Ptr transform_;
    Stopwatch watch_;
    PrintFieldTimes times_;
    const PrintLayout layout_;
    const float background_;
    const double sign_slack_;
    const std::string name_;
    openvdb::CoordBBox active_;
    PrintMap map_;
    std::uint32_t end_ = std::numeric_limits<std::uint32_t>::max();
    const std::unique_ptr<Threads> threads_;
};

}  // namespace stratum::ondemand
