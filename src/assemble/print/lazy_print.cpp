#include "assemble/print/lazy_print.h"

#include <algorithm>
#include <utility>

namespace stratum::assemble {
namespace {

using Json = nlohmann::ordered_json;

Json reportOf(const march::BrickSlots& cache, const march::BrickGrid& bricks, std::size_t limit) {
    Json report{{"limit_bytes", limit}, {"holds_all", !cache.bounded()}};
    if (!cache.bounded()) return report;
    const march::BrickCacheCounts counts = cache.counts();
    report["bricks"] = counts.slots;
    report["hits"] = counts.hits;
    report["made"] = counts.made;
    report["evicted"] = counts.evicted;
    report["peak_bytes"] = counts.peak * bricks.brickBytes();
    return report;
}

Json reportOf(const LazyLevel& level, std::size_t cache_bytes) {
    const march::BrickGrid& bricks = *level.bricks;
    Json report{{"voxel_size_mm", level.field->layout().lattice.voxel_size},
                {"bricks_listed", bricks.listedCount()},
                {"bricks_made", bricks.brickCount()},
                {"leaves_made", level.field->leavesMade()},
                {"print_bytes", level.field->bytes()},
                {"brick_bytes", bricks.bytes()}};
    if (cache_bytes != march::BrickGrid::kNoBound)
        report["brick_cache"] = reportOf(bricks.cache(), bricks, cache_bytes);
    return report;
}

}  // namespace

LazyPrint::LazyPrint(std::vector<LazyLevel> levels, std::vector<std::uint32_t> moments, std::vector<glm::dvec3> tips,
                     Times times, std::size_t cache_bytes)
    : levels_(std::move(levels)),
      moments_(std::move(moments)),
      tips_(std::move(tips)),
      times_(times),
      cache_bytes_(cache_bytes) {}

void LazyPrint::show(std::size_t moment) {
    for (const LazyLevel& level : levels_) level.bricks->update(level.field->printUntil(moments_[moment]));
}

Json LazyPrint::report() const {
    ondemand::PrintFieldTimes times;
    Json reports = Json::array();
    for (const LazyLevel& level : levels_) {
        times.bins += level.field->times().bins;
        times.box += level.field->times().box;
        times.map += level.field->times().map;
        reports.push_back(reportOf(level, cache_bytes_));
    }
    const auto sum = [&reports](const char* what) {
        std::size_t result = 0;
        for (const Json& report : reports) result += report[what].get<std::size_t>();
        return result;
    };
    const ondemand::PrintField& field = *levels_.front().field;
    Json all{{"print", field.name()},
             {"seconds",
              {{"parse", times_.parse},
               {"bins", times.bins},
               {"box", times.box},
               {"map", times.map},
               {"list", times_.all - times_.parse - times.bins - times.box - times.map}}},
             {"bricks_listed", sum("bricks_listed")},
             {"bricks_made", sum("bricks_made")},
             {"leaves_made", sum("leaves_made")},
             {"printed_beads", std::min<std::size_t>(field.printed(), field.layout().toolpath->beads.size())},
             {"print_bytes", sum("print_bytes")},
             {"brick_bytes", sum("brick_bytes")}};
    if (levels_.size() > 1)
        all["levels"] = reports;
    else if (reports.front().contains("brick_cache"))
        all["brick_cache"] = reports.front()["brick_cache"];
    return all;
}

}  // namespace stratum::assemble
