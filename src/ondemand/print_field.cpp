#include "ondemand/print_field.h"

#include "ondemand/active_box.h"
#include "ondemand/brick_map.h"

#include <tbb/enumerable_thread_specific.h>

#include <chrono>
#include <limits>
#include <utility>

namespace stratum::ondemand {
namespace {

using Clock = std::chrono::steady_clock;

double lap(Clock::time_point& last) {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last).count();
    last = now;
    return seconds;
}

struct Worker {
    explicit Worker(const PrintLayout& layout) : maker(layout) {}
    LeafMaker maker;
    std::size_t made = 0;
};

}  // namespace

struct PrintField::Threads {
    explicit Threads(const PrintLayout& layout) : workers([&layout] { return Worker(layout); }) {}
    tbb::enumerable_thread_specific<Worker> workers;
};

PrintField::PrintField(std::shared_ptr<const gcode::Toolpath> toolpath, std::span<const std::uint32_t> selection,
                       const voxelize::Lattice& lattice, const voxelize::Placement& placement, std::string name)
    : transform_(voxelize::makeTransform(lattice, placement)),
      layout_(std::move(toolpath), selection, lattice, placement.unit),
      background_(static_cast<float>(lattice.background() * placement.unit)),
      name_(std::move(name)),
      threads_(std::make_unique<Threads>(layout_)) {
    auto last = start_;
    times_.bins = lap(last);
    active_ = findActiveBox(layout_);
    times_.box = lap(last);
    map_ = mapBricks(layout_, active_);
    times_.map = lap(last);
}

PrintField::~PrintField() = default;

const float* PrintField::samples(const openvdb::Coord& origin, float* scratch) const {
    Worker& worker = threads_->workers.local();
    ++worker.made;
    const voxelize::LeafContent content = worker.maker.make(origin, std::numeric_limits<std::uint32_t>::max());
    if (content == voxelize::LeafContent::outside) return nullptr;
    std::uint64_t mask[voxelize::Leaf::NodeMaskType::WORD_COUNT];
    voxelize::storeLeaf(worker.maker.column().planes(), background_, scratch, mask);
    return scratch;
}

std::size_t PrintField::bytes() const { return layout_.bytes() + map_.masks.size() * sizeof(std::uint64_t); }

std::size_t PrintField::leavesMade() const {
    std::size_t made = 0;
    for (const Worker& worker : threads_->workers) made += worker.made;
    return made;
}

}  // namespace stratum::ondemand
