#include "convert/reports.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>

namespace stratum::tools {
namespace {

using Json = nlohmann::ordered_json;
using gcode::Limit;
using gcode::LimitOrigin;

// Klipper reads no settings of slicers.
std::string fromOf(const LimitOrigin& origin, gcode::CornerRule rule) {
    switch (origin.kind) {
        case LimitOrigin::Kind::assumed:
            return "assumed";
        case LimitOrigin::Kind::fitted:
            return "fitted to the file's TIME_ELAPSED";
        case LimitOrigin::Kind::setting:
            return fmt::format("{}the file's {}", rule == gcode::CornerRule::corner_velocity ? "assumed, from " : "",
                               origin.place);
        default:
            return origin.place;
    }
}

template <typename Take>
void eachLimit(const gcode::LimitOrigins& limits, const Take& take) {
    const auto list = [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n)
            if (gcode::isUsed(static_cast<Limit>(n), limits)) take(static_cast<Limit>(n));
    };
    // Those of whole moves first, then those of axes.
    constexpr auto kAxes = static_cast<std::size_t>(Limit::printing);
    list(kAxes, gcode::kLimitCount);
    list(0, kAxes);
}

std::string changesOf(const LimitOrigin& origin) {
    if (origin.changes == 0) return {};
    if (origin.changes == 1) return fmt::format("; line {} changes it", origin.first_change);
    return fmt::format("; {} commands change it, the first in line {}", origin.changes, origin.first_change);
}

}  // namespace

Json describeLimits(const gcode::LimitOrigins& limits) {
    Json list = Json::array();
    eachLimit(limits, [&](Limit limit) {
        const LimitOrigin& origin = limits[limit];
        list.push_back({{"name", gcode::limitName(limit, limits.rule)},
                        {"value", std::isfinite(origin.value) ? Json(origin.value) : Json(nullptr)},
                        {"unit", gcode::limitUnit(limit)},
                        {"from", fromOf(origin, limits.rule)},
                        {"changes", origin.changes},
                        {"first_change", origin.changes > 0 ? Json(origin.first_change) : Json(nullptr)}});
    });
    return list;
}

std::string limitLines(const gcode::LimitOrigins& limits) {
    std::string out = "limits:\n";
    std::string name;
    std::string values;
    std::string rest;
    const auto end = [&] {
        if (!name.empty()) out += fmt::format("  {:<30} {:<26} {}\n", name, values, rest);
    };
    eachLimit(limits, [&](Limit limit) {
        const LimitOrigin& origin = limits[limit];
        const std::string_view full = gcode::limitName(limit, limits.rule);
        const std::string_view unit = gcode::limitUnit(limit);
        // "speed x" and "speed y" become "speed x y".
        const bool axis = limit < Limit::printing && full.find(' ') != std::string_view::npos;
        std::string from = fromOf(origin, limits.rule);
        if (axis && origin.kind == LimitOrigin::Kind::setting) from.back() = '*';
        from += changesOf(origin);
        const std::string_view kind = axis ? full.substr(0, full.size() - 1) : full;
        if (axis && from == rest && name.starts_with(kind)) {
            name += fmt::format(" {}", full.back());
            values.insert(values.size() - unit.size() - 1, fmt::format(" {:g}", origin.value));
            return;
        }
        end();
        name = full;
        values = fmt::format("{:g} {}", origin.value, unit);
        rest = from;
    });
    end();
    return out;
}

}  // namespace stratum::tools
