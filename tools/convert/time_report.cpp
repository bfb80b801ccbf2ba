#include "convert/reports.h"

#include "gcode/toolpath/stated.h"
#include "gcode/toolpath/toolpath.h"

#include <fmt/format.h>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json describeTimes(const motion::PrintTimes& times, const std::optional<motion::PrintTimes>& estimate,
                   const gcode::StatedFacts& facts) {
    const motion::PrintTimes& compared = estimate ? *estimate : times;
    const motion::StatedTime time = motion::statedTime(compared, facts);
    Json features = Json::object();
    for (std::size_t i = 0; i < times.features.size(); ++i)
        if (times.features[i] > 0)
            features[std::string(gcode::featureName(static_cast<gcode::Feature>(i)))] = times.features[i];
    return {{"planned_s", times.total},
            {"stated_s", time.stated > 0 ? Json(time.stated) : Json(nullptr)},
            {"planned_of_stated_s", time.stated > 0 ? Json(time.planned) : Json(nullptr)},
            {"rule_of_stated", time.stated > 0 ? Json(compared.rule) : Json(nullptr)},
            {"rule", times.rule},
            {"limits", describeLimits(times.limits)},
            {"travel_s", times.travel},
            {"retraction_s", times.retraction},
            {"waiting_s", times.waiting},
            {"features_s", features},
            {"layers_s", times.layers}};
}

std::string timeLines(const motion::PrintTimes& times, const std::optional<motion::PrintTimes>& estimate,
                      const gcode::StatedFacts& facts) {
    const auto [stated, planned] = motion::statedTime(estimate ? *estimate : times, facts);
    std::string out = fmt::format("time: {} by the rule {}", gcode::describeDuration(times.total), times.rule);
    if (estimate)
        out += fmt::format("; {} as slicers estimate it, by the rule {}", gcode::describeDuration(estimate->total),
                           estimate->rule);
    if (stated > 0 && planned < (estimate ? *estimate : times).total)
        out += fmt::format(", {} of it {}", gcode::describeDuration(planned),
                           facts.model_seconds ? "for the model" : "without the start and the end program");
    if (stated > 0)
        out += fmt::format("; the file says {} ({:+.2f} %)", gcode::describeDuration(stated),
                           100 * (planned - stated) / stated);
    out += fmt::format("\n  travel {}, retraction {}, waiting {}", gcode::describeDuration(times.travel),
                       gcode::describeDuration(times.retraction), gcode::describeDuration(times.waiting));
    if (!times.layers.empty()) out += fmt::format(", before layer 1 {}", gcode::describeDuration(times.layers.front()));
    out += '\n';
    for (std::size_t i = 0; i < times.features.size(); ++i)
        if (times.features[i] > 0)
            out += fmt::format("  {:<20}{:>18}\n", gcode::featureName(static_cast<gcode::Feature>(i)),
                               gcode::describeDuration(times.features[i]));
    return out + limitLines(times.limits);
}

}  // namespace stratum::tools
