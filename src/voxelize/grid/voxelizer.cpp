#include "voxelize/grid/voxelizer.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/stopwatch.h"
#include "voxelize/beads/estimate.h"
#include "voxelize/beads/layer_stack.h"
#include "voxelize/grid/exterior.h"
#include "voxelize/leaf/print_columns.h"

#include <fmt/format.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace stratum::voxelize {
namespace {

// With culling, in voxels: the masks cover only the neighbouring leaves.
constexpr double kDeepestBand = 8;

using Clock = std::chrono::steady_clock;

std::size_t memoryLimit(const VoxelizeOptions& options) {
    return options.memory_limit != 0 ? options.memory_limit : availableMemory();
}

// The estimate can be off by about this factor; culling builds only a fraction of it.
double estimateMargin(Interior interior) { return interior == Interior::keep ? 3 : 30; }

// Throws if `bytes` and what a factor of `margin` may be wrong with them are more than the limit.
void refuseBeyond(double bytes, double margin, const Lattice& lattice, const VoxelizeOptions& options) {
    const std::size_t limit = memoryLimit(options);
    if (bytes <= margin * static_cast<double>(limit)) return;
    requireMemory(
        bytes, fmt::format("voxel size {:g} mm", lattice.voxel_size),
        fmt::format("choose a larger voxel (half the layer height is {:g} mm), --memory-budget, fewer "
                    "--grids, layers or features{}",
                    lattice.layer_height / 2, options.interior == Interior::keep ? ", or --interior cull" : ""),
        limit);
}

// Refuses clearly too large grids by arithmetic, before any list is made. The exact bound follows from the bins.
LayerStack stackIfItFits(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                         const Lattice& lattice, const VoxelizeOptions& options, double estimate) {
    refuseBeyond(estimate, estimateMargin(options.interior), lattice, options);
    return stackLayers(toolpath, selection);
}

}  // namespace

struct Voxelizer::State {
    State(const gcode::Toolpath& the_toolpath, std::span<const std::uint32_t> selection, const Lattice& the_lattice,
          VoxelizeOptions the_options)
        : toolpath(the_toolpath),
          lattice(the_lattice),
          options(std::move(the_options)),
          estimated_bytes(options.bytes_per_leaf > 0
                              ? estimateActiveVoxels(toolpath, selection, lattice.voxel_size, lattice.half_width) *
                                    kBytesPerActiveVoxel * (options.bytes_per_leaf / kBytesPerLeaf)
                              : 0),
          stack(stackIfItFits(toolpath, selection, lattice, options, estimated_bytes)),
          columns(toolpath, stack, lattice, options.placement.unit, LeafColumn::Kind::values, memoryLimit(options)),
          background(static_cast<float>(lattice.background() * options.placement.unit)),
          grid(emptyGrid()) {}

    openvdb::FloatGrid::Ptr emptyGrid() const {
        auto empty = openvdb::FloatGrid::create(background);
        empty->setTransform(makeTransform(lattice, options.placement));
        empty->setGridClass(openvdb::GRID_LEVEL_SET);
        empty->setName("surface");
        return empty;
    }

    void refuseIfTooLarge();
    void buildTouched(std::uint32_t end);
    void buildReached(std::uint32_t end);
    ExteriorRule exteriorRule() const;
    LeafBounds bounds() {
        if (stack.beads.empty()) return {};
        return boundLeaves(columns, leavesAround(lattice, stack));
    }

    const gcode::Toolpath& toolpath;
    const Lattice& lattice;
    const VoxelizeOptions options;
    const double estimated_bytes;
    const LayerStack stack;
    const PrintColumns columns;
    const float background;
    openvdb::FloatGrid::Ptr grid;
    std::uint32_t printed = 0;
    std::uint32_t streamed = 0;
    VoxelizeReport report;
};

void Voxelizer::State::refuseIfTooLarge() {
    if (!(options.bytes_per_leaf > 0)) return;
    // Culling builds a fraction that is unknown before the flood. Grids that clearly fit are not counted.
    if (options.interior == Interior::cull) return;
    if (estimated_bytes * estimateMargin(options.interior) * 2 < static_cast<double>(memoryLimit(options))) return;
    refuseBeyond(static_cast<double>(bounds().leaves) * options.bytes_per_leaf, 1, lattice, options);
}

void Voxelizer::State::buildTouched(std::uint32_t end) {
    // Leaves with something active; and, if there was a grid before, positions that are deep inside now.
    struct Built {
        std::vector<std::unique_ptr<Leaf>> leaves;
        std::vector<openvdb::Coord> inside;
    };
    std::vector<Built> built(columns.size());
    std::atomic<std::size_t> evaluated{0};
    const auto build = [&](std::size_t c, LeafColumn& column) {
        std::size_t count = 0;
        for (const LeafRange& range : column.touched(printed))
            for (int k = range.first; k <= range.second; ++k) {
                ++count;
                const LeafContent content = column.evaluate(k);
                if (content == LeafContent::surface)
                    built[c].leaves.push_back(column.makeLeaf());
                else if (content == LeafContent::inside && printed > 0)
                    built[c].inside.emplace_back(columns.bins().originI(c), columns.bins().originJ(c), k * kLeafDim);
            }
        evaluated.fetch_add(count, std::memory_order_relaxed);
    };
    columns.forEach(end, build, options.progress);
    std::size_t made = 0;
    auto accessor = grid->getAccessor();
    for (Built& column : built) {
        made += column.leaves.size();
        for (std::unique_ptr<Leaf>& leaf : column.leaves) accessor.addLeaf(leaf.release());
        for (const openvdb::Coord& origin : column.inside) accessor.addTile(1, origin, -background, false);
    }
    report.leaf_positions = std::max(report.leaf_positions, evaluated.load());
    report.leaves_evaluated = evaluated;
    report.leaves_reused = grid->tree().leafCount() - made;
}

ExteriorRule Voxelizer::State::exteriorRule() const {
    ExteriorRule rule;
    rule.background = background;
    rule.clearance = static_cast<float>(exteriorClearance(lattice) * options.placement.unit);
    // An outside sample next to the surface is up to a voxel from it.
    rule.band = std::clamp(lattice.half_width - 1, 1.0, kDeepestBand);
    return rule;
}

void Voxelizer::State::buildReached(std::uint32_t end) {
    const auto start = Clock::now();
    LeavesByColumn leaves;
    grid->tree().clear();
    const ExteriorCounts counts = buildReachable(columns, end, exteriorRule(), leaves, options.progress);
    const double evaluating = counts.evaluate_seconds / tbb::this_task_arena::max_concurrency();
    report.exterior_seconds = std::max(secondsSince(start) - evaluating, 0.0);
    auto accessor = grid->getAccessor();
    for (auto& column : leaves)
        for (std::unique_ptr<Leaf>& leaf : column) accessor.addLeaf(leaf.release());
    report.leaf_positions = counts.positions;
    report.leaves_evaluated = counts.evaluated;
    report.flood_rounds = counts.rounds;
}

Voxelizer::Voxelizer(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection, const Lattice& lattice,
                     VoxelizeOptions options) {
    const auto start = Clock::now();
    state_ = std::make_unique<State>(toolpath, selection, lattice, std::move(options));
    state_->refuseIfTooLarge();
    state_->report.bin_seconds = secondsSince(start);
}

Voxelizer::~Voxelizer() = default;

openvdb::FloatGrid::Ptr Voxelizer::printUntil(std::uint32_t end) {
    const auto start = Clock::now();
    if (state_->options.interior == Interior::keep)
        state_->buildTouched(end);
    else
        state_->buildReached(end);
    state_->printed = end;
    // Tiles get the sign of the adjacent leaves; leaves have theirs already.
    openvdb::tools::signedFloodFill(state_->grid->tree(), true, 1, 1);
    state_->report.build_seconds = secondsSince(start);
    return state_->grid;
}

LeafBounds Voxelizer::leafBounds() const { return state_->bounds(); }

LeafStreamReport Voxelizer::stream(std::uint32_t end, const LeafBounds& bounds, LeafReceiver& receiver, bool measure) {
    const auto start = Clock::now();
    const LeafStreamReport streamed =
        streamLeaves(state_->columns, end, bounds, receiver, measure, state_->options.progress);
    state_->streamed = end;
    VoxelizeReport& report = state_->report;
    report.leaf_positions = report.leaves_evaluated = streamed.evaluated;
    report.build_seconds = secondsSince(start);
    return streamed;
}

openvdb::FloatGrid::Ptr Voxelizer::emptyGrid() const { return state_->emptyGrid(); }

CullForecast Voxelizer::forecastCull() const {
    State& s = *state_;
    const ExteriorCounts counts = countReachable(s.columns, s.printed, s.exteriorRule(), s.grid->constTree());
    return {counts.kept, counts.kept_voxels};
}

std::vector<openvdb::GridBase::Ptr> Voxelizer::attributes(std::span<const Attribute> wanted) const {
    const State& s = *state_;
    if (wanted.empty()) return {};
    // OpenVDB's copies of a topology do not survive a failed allocation.
    refuseBeyond((bytesPerLeaf(wanted) - kBytesPerLeaf) * s.grid->tree().leafCount(), 1, s.lattice, s.options);
    std::vector<openvdb::GridBase::Ptr> grids = makeAttributeGrids(s.toolpath, wanted, *s.grid);
    const bool overfill = std::find(wanted.begin(), wanted.end(), Attribute::overfill) != wanted.end();
    const BeadAttributes values(s.toolpath, wanted,
                                overfill ? overfillOfBeads(s.toolpath, s.stack) : std::vector<float>());
    constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();
    const auto fill = [&](std::size_t c, LeafColumn& column) {
        std::array<std::uint32_t, Leaf::SIZE> owners{};
        for (const LeafRange& range : column.touched())
            for (int k = range.first; k <= range.second; ++k) {
                const openvdb::Coord origin(s.columns.bins().originI(c), s.columns.bins().originJ(c), k * kLeafDim);
                if (s.grid->tree().probeConstLeaf(origin) == nullptr) continue;
                column.evaluate(k);
                column.owners(owners);
                for (std::uint32_t& owner : owners)
                    if (owner != kNobody) owner = s.stack.beads[owner];
                for (std::size_t n = 0; n < wanted.size(); ++n) fillLeaf(*grids[n], wanted[n], origin, values, owners);
            }
    };
    s.columns.forEach(s.printed, fill, s.options.progress);
    return grids;
}

DepositBalance Voxelizer::balance() const {
    const State& s = *state_;
    const std::uint32_t end = std::max(s.printed, s.streamed);
    return balanceDeposit(s.toolpath, s.stack, end > 0 ? end : static_cast<std::uint32_t>(s.toolpath.beads.size()));
}

const VoxelizeReport& Voxelizer::report() const { return state_->report; }

openvdb::FloatGrid::Ptr voxelize(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection,
                                 const Lattice& lattice, const VoxelizeOptions& options) {
    return Voxelizer(toolpath, selection, lattice, options).printAll();
}

}  // namespace stratum::voxelize
