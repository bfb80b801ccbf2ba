#include "voxelize/selection.h"

#include "io/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace stratum::voxelize {
namespace {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    while (true) {
        const std::size_t end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

template <typename Number>
std::optional<Number> parseNumber(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

// By layer, the index after the last bead of that layer and those below. Beads are looked at once, for all layers.
std::vector<std::size_t> endsOfLayers(const gcode::Toolpath& toolpath) {
    std::vector<std::size_t> ends(std::size_t{toolpath.layer_count} + 1, 0);
    for (std::size_t i = 0; i < toolpath.beads.size(); ++i) {
        const std::uint32_t layer = toolpath.runOf(toolpath.beads[i]).layer;
        if (layer < ends.size()) ends[layer] = i + 1;
    }
    for (std::size_t layer = 1; layer < ends.size(); ++layer) ends[layer] = std::max(ends[layer], ends[layer - 1]);
    return ends;
}

std::size_t endOfShare(const gcode::Toolpath& toolpath, double share) {
    // The margin keeps half of twenty equal beads at ten, whatever the rounding of the sum.
    const double target = share * gcode::beadVolume(toolpath) * (1 - 1e-9);
    double sum = 0;
    for (std::size_t i = 0; i < toolpath.beads.size(); ++i) {
        const gcode::Bead& bead = toolpath.beads[i];
        sum += gcode::beadLength(toolpath, bead) * gcode::sectionArea(bead.width, toolpath.runOf(bead).height);
        if (sum >= target) return i + 1;
    }
    return toolpath.beads.size();
}

std::size_t endOfTime(const gcode::Toolpath& toolpath, double seconds) {
    double time = 0;
    for (std::size_t i = 0; i < toolpath.beads.size(); ++i) {
        time += gcode::beadSeconds(toolpath, toolpath.beads[i]);
        if (time > seconds) return i;
    }
    return toolpath.beads.size();
}

}  // namespace

void parseLayers(std::string_view text, Selection& selection) {
    const auto parts = split(text, ':');
    const auto number = [&](std::string_view part, std::uint32_t fallback) {
        if (part.empty()) return fallback;
        const auto value = parseNumber<std::uint32_t>(part);
        if (!value) throw UsageError(fmt::format("--layers {}: expected A:B with whole numbers, e.g. 1:40", text));
        return *value;
    };
    if (parts.size() > 2 || text.empty())
        throw UsageError(fmt::format("--layers {}: expected A:B with whole numbers, e.g. 1:40", text));
    selection.first_layer = number(parts.front(), 1);
    selection.last_layer = parts.size() == 2 ? number(parts.back(), 0xffffffff) : selection.first_layer;
    if (selection.first_layer > selection.last_layer)
        throw UsageError(fmt::format("--layers {}: the first layer is above the last", text));
}

void parseFeatures(std::string_view text, Selection& selection) {
    bool first = true;
    for (const std::string_view part : split(text, ',')) {
        const gcode::Feature feature = part.size() < 2 ? gcode::Feature::count_ : gcode::featureNamed(part.substr(1));
        if (feature == gcode::Feature::count_ || (part[0] != '+' && part[0] != '-')) {
            std::string names;
            for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
                names += fmt::format(" {}", gcode::featureName(static_cast<gcode::Feature>(f)));
            throw UsageError(fmt::format(
                "--features {}: expected +NAME or -NAME, separated by commas; the names are:{}", part, names));
        }
        // A list that starts with + names what to keep; one that starts with - names what to drop.
        if (first) selection.features.fill(part[0] == '-');
        first = false;
        selection.features[static_cast<std::size_t>(feature)] = part[0] == '+';
    }
}

void chooseObject(std::string_view name_or_number, const gcode::Toolpath& toolpath, Selection& selection) {
    const auto& objects = toolpath.objects;
    const auto named = std::find(objects.begin() + 1, objects.end(), name_or_number);
    if (named != objects.end()) return selection.objects.push_back(static_cast<std::uint16_t>(named - objects.begin()));
    const auto number = parseNumber<std::uint16_t>(name_or_number);
    if (number && *number < objects.size()) return selection.objects.push_back(*number);
    if (objects.size() == 1)
        throw UsageError(
            fmt::format("--object {}: the file names no objects; the slicer's option to label objects "
                        "makes it do so",
                        name_or_number));
    constexpr std::size_t kMostListed = 50;
    std::string list;
    for (std::size_t i = 1; i < std::min(objects.size(), kMostListed + 1); ++i)
        list += fmt::format("\n  {}: {}", i, objects[i]);
    if (objects.size() > kMostListed + 1) list += fmt::format("\n  and {} more", objects.size() - 1 - kMostListed);
    throw UsageError(
        fmt::format("--object {}: there is no such object; by number or name it is one of{}", name_or_number, list));
}

std::vector<std::uint32_t> selectBeads(const gcode::Toolpath& toolpath, const Selection& selection) {
    std::vector<char> object_kept(toolpath.objects.size(), selection.objects.empty() ? 1 : 0);
    for (const std::uint16_t object : selection.objects) object_kept[object] = 1;
    std::vector<char> run_kept;
    run_kept.reserve(toolpath.runs.size());
    for (const gcode::Run& run : toolpath.runs)
        run_kept.push_back(run.layer >= selection.first_layer && run.layer <= selection.last_layer &&
                           object_kept[run.object] != 0 && selection.features[static_cast<std::size_t>(run.feature)]);
    std::vector<std::uint32_t> beads;
    for (std::uint32_t i = 0; i < toolpath.beads.size(); ++i)
        if (run_kept[toolpath.beads[i].run]) beads.push_back(i);
    if (beads.empty()) {
        std::array<bool, gcode::kFeatureCount> present{};
        for (const gcode::Run& run : toolpath.runs) present[static_cast<std::size_t>(run.feature)] = true;
        std::string names;
        for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
            if (present[f]) names += fmt::format(" {}", gcode::featureName(static_cast<gcode::Feature>(f)));
        throw InputError(
            fmt::format("no bead is left by --layers, --features and --object; the print has layers 1 to {} and{}",
                        toolpath.layer_count, names));
    }
    return beads;
}

std::vector<Snapshot> parseSnapshots(std::string_view text, const gcode::Toolpath& toolpath, std::string_view option) {
    std::vector<Snapshot> snapshots;
    std::vector<std::size_t> ends;
    const auto endOfLayer = [&](std::uint32_t layer) {
        if (ends.empty()) ends = endsOfLayers(toolpath);
        return ends[layer];
    };
    for (const std::string_view part : split(text, ',')) {
        const auto bad = [&] {
            return UsageError(
                fmt::format("{} {}: expected N% (0 to 100), layer:N, every:N or time:MINUTES, separated by "
                            "commas; the print has layers 1 to {}",
                            option, part, toolpath.layer_count));
        };
        if (part.ends_with('%')) {
            const auto percent = parseNumber<double>(part.substr(0, part.size() - 1));
            if (!percent || !(*percent > 0 && *percent <= 100)) throw bad();
            snapshots.push_back({fmt::format("{:g}pct", *percent), endOfShare(toolpath, *percent / 100)});
        } else if (part.starts_with("layer:")) {
            const auto layer = parseNumber<std::uint32_t>(part.substr(6));
            if (!layer || *layer > toolpath.layer_count) throw bad();
            snapshots.push_back({fmt::format("layer{:04}", *layer), endOfLayer(*layer)});
        } else if (part.starts_with("every:")) {
            const auto step = parseNumber<std::uint32_t>(part.substr(6));
            if (!step || *step == 0) throw bad();
            for (std::uint64_t layer = *step; layer <= toolpath.layer_count; layer += *step)
                snapshots.push_back({fmt::format("layer{:04}", layer), endOfLayer(static_cast<std::uint32_t>(layer))});
        } else if (part.starts_with("time:")) {
            const auto minutes = parseNumber<double>(part.substr(5));
            if (!minutes || !(*minutes > 0)) throw bad();
            snapshots.push_back({fmt::format("{:g}min", *minutes), endOfTime(toolpath, *minutes * 60)});
        } else {
            throw bad();
        }
    }
    std::erase_if(snapshots, [](const Snapshot& s) { return s.bead_count == 0; });
    std::stable_sort(snapshots.begin(), snapshots.end(),
                     [](const Snapshot& a, const Snapshot& b) { return a.bead_count < b.bead_count; });
    const auto same = [](const Snapshot& a, const Snapshot& b) { return a.label == b.label; };
    snapshots.erase(std::unique(snapshots.begin(), snapshots.end(), same), snapshots.end());
    return snapshots;
}

}  // namespace stratum::voxelize
