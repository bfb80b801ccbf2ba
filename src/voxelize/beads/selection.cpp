#include "voxelize/beads/selection.h"

#include "base/error.h"
#include "base/names.h"
#include "base/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <tuple>

namespace stratum::voxelize {
namespace {

// By layer, the index after the last bead of that layer and those below. One pass over the beads for all layers.
std::vector<std::size_t> endsOfLayers(const gcode::Toolpath& toolpath) {
    std::vector<std::size_t> ends(std::size_t{toolpath.layer_count} + 1, 0);
    for (std::size_t i = 0; i < toolpath.beads.size(); ++i) {
        const std::uint32_t layer = toolpath.runOf(toolpath.beads[i]).layer;
        if (layer < ends.size()) ends[layer] = i + 1;
    }
    for (std::size_t layer = 1; layer < ends.size(); ++layer) ends[layer] = std::max(ends[layer], ends[layer - 1]);
    return ends;
}

// Of the layers: prime lines are drawn by nothing but --layers 0:.
std::size_t endOfShare(const gcode::Toolpath& toolpath, double share) {
    std::vector<double> volumes(toolpath.beads.size());
    double all = 0;
    for (std::uint32_t i = 0; i < volumes.size(); ++i) {
        if (toolpath.runOf(toolpath.beads[i]).layer > 0) volumes[i] = gcode::laidVolume(toolpath, i);
        all += volumes[i];
    }
    // With the margin, half of twenty equal beads is ten, however the sum is rounded.
    const double target = share * all * (1 - 1e-9);
    double sum = 0;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        sum += volumes[i];
        if (sum >= target) return i + 1;
    }
    return volumes.size();
}

// When each bead is finished, in s.
std::vector<double> endsOfBeads(const gcode::Toolpath& toolpath) {
    std::vector<double> ends;
    ends.reserve(toolpath.beads.size());
    for (const gcode::BeadTiming& timing : toolpath.timing)
        ends.push_back(timing.start + static_cast<double>(timing.seconds));
    if (!ends.empty()) return ends;
    double time = 0;
    for (const gcode::Bead& bead : toolpath.beads) ends.push_back(time += gcode::beadSeconds(toolpath, bead));
    return ends;
}

/// A snapshot whose label is not yet padded to the length of the others.
struct Cut {
    enum class Kind { percent, layer, bead, seconds, minutes, hours, time_share, count_ } kind;
    double value;
    std::size_t bead_count;
};

// Digits after the decimal point of a number, 6 at most.
int decimalsOf(double value) {
    std::string text = fmt::format("{:.6f}", value);
    text.erase(text.find_last_not_of('0') + 1);
    return static_cast<int>(text.size() - text.find('.')) - 1;
}

// Labels of one kind have as many digits before and after the point, so that names of files sort as the numbers do.
std::vector<Snapshot> labelled(const std::vector<Cut>& cuts, std::uint32_t layer_count) {
    std::array<int, static_cast<std::size_t>(Cut::Kind::count_)> decimals{};
    for (const Cut& cut : cuts) {
        int& most = decimals[static_cast<std::size_t>(cut.kind)];
        most = std::max(most, decimalsOf(cut.value));
    }
    const int layer_digits = std::max(4, static_cast<int>(std::to_string(layer_count).size()));
    const auto number = [&decimals](const Cut& cut, int digits) {
        const int behind = decimals[static_cast<std::size_t>(cut.kind)];
        return fmt::format("{:0{}.{}f}", cut.value, digits + (behind > 0 ? 1 + behind : 0), behind);
    };
    const auto labelOf = [&](const Cut& cut) -> std::string {
        switch (cut.kind) {
            case Cut::Kind::percent:
                return number(cut, 3) + "pct";
            case Cut::Kind::layer:
                return "layer" + number(cut, layer_digits);
            case Cut::Kind::bead:
                return "bead" + number(cut, 9);
            case Cut::Kind::seconds:
                return number(cut, 6) + "s";
            case Cut::Kind::minutes:
                return number(cut, 4) + "min";
            case Cut::Kind::hours:
                return number(cut, 3) + "h";
            default:
                return "time" + number(cut, 3) + "pct";
        }
    };
    std::vector<Snapshot> snapshots;
    for (const Cut& cut : cuts) {
        if (cut.bead_count == 0) continue;
        snapshots.push_back({labelOf(cut), cut.bead_count});
    }
    return snapshots;
}

// "90" (minutes), "5400s", "90m", "1.5h" or "50%"; nullopt if it is none of them.
std::optional<Cut> momentOf(std::string_view text, const gcode::Toolpath& toolpath) {
    constexpr std::string_view kUnits = "smh%";
    constexpr std::array<double, 3> kSeconds{1, 60, 3600};
    const std::size_t unit = text.empty() ? std::string_view::npos : kUnits.find(text.back());
    const bool named = unit != std::string_view::npos;
    const auto value = parsed<double>(named ? text.substr(0, text.size() - 1) : text);
    if (!value || !(*value > 0 && *value < 1e9)) return std::nullopt;
    const bool share = named && unit == kSeconds.size();
    if (share && *value > 100) return std::nullopt;
    const std::vector<double> ends = endsOfBeads(toolpath);
    // With the margin, 100 % is all beads, however the sum is rounded.
    const double seconds =
        share ? *value / 100 * (ends.empty() ? 0 : ends.back()) * (1 + 1e-9) : *value * (named ? kSeconds[unit] : 60);
    const auto late = [seconds](double end) { return end > seconds; };
    const auto count = static_cast<std::size_t>(std::find_if(ends.begin(), ends.end(), late) - ends.begin());
    constexpr std::array<Cut::Kind, 4> kKinds{Cut::Kind::seconds, Cut::Kind::minutes, Cut::Kind::hours,
                                              Cut::Kind::time_share};
    return Cut{named ? kKinds[unit] : Cut::Kind::minutes, *value, count};
}

// T numbers that print something.
std::set<int> toolsOf(const gcode::Toolpath& toolpath) {
    std::set<int> tools;
    for (const gcode::Run& run : toolpath.runs) tools.insert(run.tool);
    return tools;
}

}  // namespace

void parseLayers(std::string_view text, Selection& selection) {
    const auto parts = split(text, ':');
    const auto number = [&](std::string_view part, std::uint32_t fallback) {
        if (part.empty()) return fallback;
        const auto value = parsed<std::uint32_t>(part);
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
    if (text == "all") return selection.features.fill(true);
    bool first = true;
    for (const std::string_view part : split(text, ',')) {
        const gcode::Feature feature = part.size() < 2 ? gcode::Feature::count_ : gcode::featureNamed(part.substr(1));
        if (feature == gcode::Feature::count_ || (part[0] != '+' && part[0] != '-')) {
            std::vector<std::string_view> names;
            for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
                names.push_back(gcode::featureName(static_cast<gcode::Feature>(f)));
            const bool sign = part.starts_with('+') || part.starts_with('-');
            throw UsageError(
                fmt::format("--features {}: expected all, or +NAME or -NAME, separated by commas; the names are: {}{}",
                            part, fmt::join(names, " "),
                            !sign && gcode::featureNamed(part) != gcode::Feature::count_
                                ? fmt::format("; +{0} keeps that alone, -{0} leaves it out", part)
                                : didYouMean(part.substr(sign ? 1 : 0), names)));
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
    const auto number = parsed<std::uint16_t>(name_or_number);
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

void chooseTool(std::uint8_t tool, const gcode::Toolpath& toolpath, Selection& selection) {
    const std::set<int> tools = toolsOf(toolpath);
    if (!tools.contains(tool))
        throw UsageError(fmt::format("--tool {}: the print has no such tool; {} {}", tool,
                                     tools.size() == 1 ? "all of it is by tool" : "its tools are",
                                     fmt::join(tools, ", ")));
    selection.tools.push_back(tool);
}

std::vector<std::uint32_t> selectBeads(const gcode::Toolpath& toolpath, const Selection& selection) {
    std::vector<char> object_kept(toolpath.objects.size(), selection.objects.empty() ? 1 : 0);
    for (const std::uint16_t object : selection.objects) object_kept[object] = 1;
    const auto tool_kept = [&selection](std::uint8_t tool) {
        return selection.tools.empty() ||
               std::find(selection.tools.begin(), selection.tools.end(), tool) != selection.tools.end();
    };
    std::vector<char> run_kept;
    run_kept.reserve(toolpath.runs.size());
    for (const gcode::Run& run : toolpath.runs)
        run_kept.push_back(run.layer >= selection.first_layer && run.layer <= selection.last_layer &&
                           object_kept[run.object] != 0 && tool_kept(run.tool) &&
                           selection.features[static_cast<std::size_t>(run.feature)]);
    std::vector<std::uint32_t> beads;
    for (std::uint32_t i = 0; i < toolpath.beads.size(); ++i)
        if (run_kept[toolpath.beads[i].run]) beads.push_back(i);
    if (beads.empty()) {
        if (toolpath.layer_count == 0)
            throw InputError(
                "nothing of a print is in the program, only prime lines before its first layer; is the file whole?");
        std::array<bool, gcode::kFeatureCount> present{};
        for (const gcode::Run& run : toolpath.runs) present[static_cast<std::size_t>(run.feature)] = true;
        std::string names;
        for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
            if (present[f]) names += fmt::format(" {}", gcode::featureName(static_cast<gcode::Feature>(f)));
        throw InputError(
            fmt::format("no bead is left by --layers, --features, --object and --tool; the print has layers 1 to {}, "
                        "tools {} and{}",
                        toolpath.layer_count, fmt::join(toolsOf(toolpath), ", "), names));
    }
    return beads;
}

bool needsTiming(std::string_view snapshots) { return snapshots.find("time:") != std::string_view::npos; }

std::vector<Snapshot> parseSnapshots(std::string_view text, const gcode::Toolpath& toolpath, std::string_view option) {
    std::vector<Cut> cuts;
    std::vector<std::size_t> ends;
    const auto endOfLayer = [&](std::uint32_t layer) {
        if (ends.empty()) ends = endsOfLayers(toolpath);
        return ends[layer];
    };
    for (const std::string_view part : split(text, ',')) {
        const auto bad = [&] {
            return UsageError(fmt::format(
                "{} {}: expected N% (above 0, to 100), layer:N, bead:N, every:N, time:MINUTES, time:SECONDSs "
                "or time:N%, separated by commas; the print has layers 1 to {} and {} beads",
                option, part, toolpath.layer_count, toolpath.beads.size()));
        };
        if (part.ends_with('%') && !part.starts_with("time:")) {
            const auto percent = parsed<double>(part.substr(0, part.size() - 1));
            if (!percent || !(*percent > 0 && *percent <= 100)) throw bad();
            cuts.push_back({Cut::Kind::percent, *percent, endOfShare(toolpath, *percent / 100)});
        } else if (part.starts_with("layer:")) {
            const auto layer = parsed<std::uint32_t>(part.substr(6));
            if (!layer || *layer > toolpath.layer_count) throw bad();
            cuts.push_back({Cut::Kind::layer, static_cast<double>(*layer), endOfLayer(*layer)});
        } else if (part.starts_with("bead:")) {
            const auto count = parsed<std::uint32_t>(part.substr(5));
            if (!count || *count == 0 || *count > toolpath.beads.size()) throw bad();
            cuts.push_back({Cut::Kind::bead, static_cast<double>(*count), *count});
        } else if (part.starts_with("every:")) {
            const auto step = parsed<std::uint32_t>(part.substr(6));
            if (!step || *step == 0) throw bad();
            for (std::uint64_t layer = *step; layer <= toolpath.layer_count; layer += *step)
                cuts.push_back(
                    {Cut::Kind::layer, static_cast<double>(layer), endOfLayer(static_cast<std::uint32_t>(layer))});
        } else if (part.starts_with("time:")) {
            const auto moment = momentOf(part.substr(5), toolpath);
            if (!moment) throw bad();
            cuts.push_back(*moment);
        } else {
            throw bad();
        }
    }
    std::vector<Snapshot> snapshots = labelled(cuts, toolpath.layer_count);
    std::stable_sort(snapshots.begin(), snapshots.end(), [](const Snapshot& a, const Snapshot& b) {
        return std::tie(a.bead_count, a.label) < std::tie(b.bead_count, b.label);
    });
    const auto same = [](const Snapshot& a, const Snapshot& b) { return a.label == b.label; };
    snapshots.erase(std::unique(snapshots.begin(), snapshots.end(), same), snapshots.end());
    return snapshots;
}

}  // namespace stratum::voxelize
