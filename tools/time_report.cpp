#include "time_report.h"

#include "gcode/toolpath.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kCurasPlaceholder = 6666;

// "1d 2h 3m 4s", any of them; up to the first thing that is none.
double durationOf(std::string_view text) {
    double seconds = 0;
    while (true) {
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
        double value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc{} || end == text.data() + text.size()) return seconds;
        const double unit = *end == 'd' ? 86400 : *end == 'h' ? 3600 : *end == 'm' ? 60 : *end == 's' ? 1 : 0;
        if (unit == 0 || !(value >= 0 && value < 1e7)) return seconds;
        seconds += unit * value;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()) + 1);
    }
}

// Of the first key that stands there: its statement.
double find(std::string_view part) {
    for (const std::string_view key : {"; estimated printing time (normal mode) = ", "; model printing time: "})
        if (const auto at = part.find(key); at != std::string_view::npos)
            return durationOf(part.substr(at + key.size()));
    constexpr std::string_view kCura = "\n;TIME:";
    if (const auto at = part.find(kCura); at != std::string_view::npos) {
        double value = 0;
        const std::string_view text = part.substr(at + kCura.size());
        std::from_chars(text.data(), text.data() + text.size(), value);
        if (value > 0 && value < 1e7 && value != kCurasPlaceholder) return value;
    }
    return 0;
}

std::string clock(double seconds) {
    const auto whole = static_cast<long long>(seconds + 0.5);
    return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
}

}  // namespace

double statedSeconds(std::string_view gcode) {
    constexpr std::size_t kReach = std::size_t{1} << 18;  // as of the other settings
    const double head = find(gcode.substr(0, kReach));
    return head > 0 ? head : find(gcode.substr(gcode.size() - std::min(kReach, gcode.size())));
}

Json describeTimes(const motion::PrintTimes& times, double stated) {
    Json features = Json::object();
    for (std::size_t i = 0; i < times.features.size(); ++i)
        if (times.features[i] > 0)
            features[std::string(gcode::featureName(static_cast<gcode::Feature>(i)))] = times.features[i];
    return {{"planned_s", times.total},
            {"stated_s", stated > 0 ? Json(stated) : Json(nullptr)},
            {"rule", times.rule},
            {"travel_s", times.travel},
            {"retraction_s", times.retraction},
            {"waiting_s", times.waiting},
            {"features_s", features},
            {"layers_s", times.layers}};
}

std::string timeLines(const motion::PrintTimes& times, double stated) {
    std::string out = fmt::format("time: {} by the rule {}", clock(times.total), times.rule);
    if (stated > 0)
        out += fmt::format("; the file says {} ({:+.2f} %)", clock(stated), 100 * (times.total - stated) / stated);
    out += fmt::format("\n  travel {}, retraction {}, waiting {}", clock(times.travel), clock(times.retraction),
                       clock(times.waiting));
    if (!times.layers.empty()) out += fmt::format(", before layer 1 {}", clock(times.layers.front()));
    out += '\n';
    for (std::size_t i = 0; i < times.features.size(); ++i)
        if (times.features[i] > 0)
            out += fmt::format("  {:<20}{:>12}\n", gcode::featureName(static_cast<gcode::Feature>(i)),
                               clock(times.features[i]));
    return out;
}

}  // namespace stratum::tools
