#include "mechanics/element_sets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

namespace stratum::mechanics {

BeadDirection directionAt(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double x, double y) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const auto [dx, dy, climb] = gcode::pathDirection(toolpath, bead, x, y);
    const double plan = std::hypot(dx, dy);
    if (dx == 0 && dy == 0 && climb == 0) return {};
    long azimuth = dx == 0 && dy == 0 ? 0 : std::lround(std::atan2(dy, dx) * kDegrees);
    long elevation = std::lround(std::atan2(climb, plan) * kDegrees);
    if (azimuth < 0) {
        azimuth += 180;
        elevation = -elevation;
    }
    // atan2's half turn, and what the line above makes of it: back along x.
    if (azimuth == 180) {
        azimuth = 0;
        elevation = -elevation;
    }
    if (elevation == -90) elevation = 90;
    return {static_cast<std::int16_t>(azimuth), static_cast<std::int16_t>(elevation)};
}

namespace {

void add(std::vector<NumberRange>& members, std::uint32_t number) {
    if (!members.empty() && members.back().last + 1 == number)
        members.back().last = number;
    else
        members.push_back({number, number});
}

// What a set is named by: a number of each run.
struct Kind {
    std::function<std::uint32_t(const gcode::Run&)> key;
    std::function<std::string(std::uint32_t)> name;
};

std::string capitals(std::string_view name) {
    std::string text(name);
    for (char& c : text) c = c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

const std::vector<Kind>& kinds() {
    static const std::vector<Kind> all{
        {[](const gcode::Run& run) { return run.layer; }, [](std::uint32_t n) { return fmt::format("LAYER_{}", n); }},
        {[](const gcode::Run& run) { return static_cast<std::uint32_t>(run.feature); },
         [](std::uint32_t n) {
             return fmt::format("FEATURE_{}", capitals(gcode::featureName(static_cast<gcode::Feature>(n))));
         }},
        {[](const gcode::Run& run) { return std::uint32_t{run.tool}; },
         [](std::uint32_t n) { return fmt::format("TOOL_{}", n); }}};
    return all;
}

// The elements of each key.
std::map<std::uint32_t, std::vector<NumberRange>> elementsBy(const Kind& kind, const SolidElements& elements,
                                                             const gcode::Toolpath& toolpath) {
    std::map<std::uint32_t, std::vector<NumberRange>> sets;
    std::vector<std::uint32_t> keys;
    keys.reserve(toolpath.runs.size());
    for (const gcode::Run& run : toolpath.runs) keys.push_back(kind.key(run));
    std::uint32_t last_key = 0;
    std::vector<NumberRange>* set = nullptr;  // of the last key: neighbours mostly share one
    for (std::uint32_t n = 0; n < elements.list.size(); ++n) {
        const std::uint32_t key = keys[toolpath.beads[elements.list[n].bead].run];
        if (set == nullptr || key != last_key) set = &sets[key];
        last_key = key;
        add(*set, n);
    }
    return sets;
}

void addSides(const Hexahedra& mesh, bool leans, std::vector<NamedSet>& sets) {
    Node low = mesh.nodes.front();
    Node high = low;
    for (const Node& node : mesh.nodes) {
        low = {std::min(low.i, node.i), std::min(low.j, node.j), std::min(low.k, node.k)};
        high = {std::max(high.i, node.i), std::max(high.j, node.j), std::max(high.k, node.k)};
    }
    const auto side = [&](const char* name, std::int32_t Node::*axis, std::int32_t place) {
        NamedSet set{name, {}};
        for (std::uint32_t n = 0; n < mesh.nodes.size(); ++n)
            if (mesh.nodes[n].*axis == place) add(set.members, n);
        sets.push_back(std::move(set));
    };
    if (!leans) {
        side("BED", &Node::k, low.k);
        side("TOP", &Node::k, high.k);
    }
    side("XMIN", &Node::i, low.i);
    side("XMAX", &Node::i, high.i);
    if (leans) return;
    side("YMIN", &Node::j, low.j);
    side("YMAX", &Node::j, high.j);
}

}  // namespace

std::vector<NamedSet> elementSets(const SolidElements& elements, const gcode::Toolpath& toolpath) {
    std::vector<NamedSet> sets;
    for (const Kind& kind : kinds())
        for (auto& [key, members] : elementsBy(kind, elements, toolpath))
            sets.push_back({kind.name(key), std::move(members)});
    return sets;
}

std::vector<NamedSet> nodeSets(const SolidElements& elements, const Hexahedra& mesh, const gcode::Toolpath& toolpath) {
    std::vector<NamedSet> sets;
    if (mesh.nodes.empty()) return sets;
    addSides(mesh, toolpath.belt_angle != 0, sets);
    for (const Kind& kind : kinds()) {
        constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
        std::vector<std::uint32_t> seen_by(mesh.nodes.size(), kNone);  // the last set that took a node
        std::uint32_t number = 0;
        std::vector<std::uint32_t> nodes;
        for (const auto& [key, members] : elementsBy(kind, elements, toolpath)) {
            nodes.clear();
            for (const NumberRange& range : members)
                for (std::uint32_t e = range.first; e <= range.last; ++e)
                    for (const std::uint32_t node : mesh.corners[e]) {
                        if (seen_by[node] == number) continue;
                        seen_by[node] = number;
                        nodes.push_back(node);
                    }
            ++number;
            std::sort(nodes.begin(), nodes.end());
            NamedSet set{kind.name(key), {}};
            for (const std::uint32_t node : nodes) add(set.members, node);
            sets.push_back(std::move(set));
        }
    }
    return sets;
}

std::map<BeadDirection, NamedSet> directionSets(const SolidElements& elements, const gcode::Toolpath& toolpath) {
    std::map<BeadDirection, NamedSet> sets;
    for (std::uint32_t n = 0; n < elements.list.size(); ++n) {
        const SolidElement& e = elements.list[n];
        const double x = elements.origin[0] + (e.i + 0.5) * elements.edge;
        const double y = elements.origin[1] + (e.j + 0.5) * elements.edge;
        add(sets[directionAt(toolpath, toolpath.beads[e.bead], x, y)].members, n);
    }
    for (auto& [direction, set] : sets) {
        set.name = fmt::format("ALONG_{}", direction.azimuth);
        if (direction.elevation != 0)
            set.name += fmt::format("_{}_{}", direction.elevation > 0 ? "UP" : "DOWN", std::abs(direction.elevation));
    }
    return sets;
}

}  // namespace stratum::mechanics
