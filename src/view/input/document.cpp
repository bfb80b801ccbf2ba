#include "view/input/document.h"

#include "assemble/file/input_files.h"
#include "base/error.h"
#include "gcode/summary.h"
#include "shade/finish/named_brdf.h"
#include "voxelize/beads/placement.h"
#include "voxelize/grid/attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <random>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

// By which a page may colour. Overfill takes seconds of a large print, and is none of a page's.
std::vector<std::string_view> attributesOf(const gcode::Toolpath* print) {
    std::vector<std::string_view> names = voxelize::attributeNames();
    std::erase_if(names, [print](std::string_view name) {
        if (name == "overfill") return true;
        if (print == nullptr) return false;
        return (name == "temperature" && print->temperatures.empty()) || (name == "fan" && print->fans.empty()) ||
               (name == "acceleration" && print->accelerations.empty()) ||
               (name == "pressure_advance" && print->pressure_advances.empty());
    });
    return names;
}

Json factsOf(const gcode::Toolpath& toolpath) {
    Json features = Json::array();
    const auto totals = gcode::featureTotals(toolpath);
    // Prime lines, which are in layer 0, are not drawn.
    std::array<bool, gcode::kFeatureCount> drawn{};
    std::set<int> tools;
    for (const gcode::Bead& bead : toolpath.beads)
        if (const gcode::Run& run = toolpath.runOf(bead); run.layer > 0) {
            drawn[static_cast<std::size_t>(run.feature)] = true;
            tools.insert(run.tool);
        }
    for (std::size_t n = 0; n < totals.size(); ++n)
        if (drawn[n])
            features.push_back({{"name", gcode::featureName(static_cast<gcode::Feature>(n))},
                                {"length_mm", totals[n].length},
                                {"volume_mm3", totals[n].volume}});
    Json objects = Json::array();
    // Beads without an object are hidden and shown on their own, too.
    const auto unlabelled = [](const gcode::Run& run) { return run.object == 0 && run.layer > 0; };
    if (toolpath.objects.size() > 1 && std::any_of(toolpath.runs.begin(), toolpath.runs.end(), unlabelled))
        objects.push_back({{"number", 0}, {"name", "no object"}});
    for (std::size_t n = 1; n < toolpath.objects.size(); ++n)
        objects.push_back({{"number", n}, {"name", toolpath.objects[n].substr(0, 200)}});
    const voxelize::Placement lies = voxelize::placementOf(toolpath);
    double highest = 0.0;
    for (const gcode::Bead& bead : toolpath.beads)
        highest = std::max(highest, voxelize::worldOf({bead.x1, bead.y1, bead.z1}, lies)[2]);
    Json facts{{"layers", toolpath.layer_count}, {"features", std::move(features)},
               {"objects", std::move(objects)},  {"tools", tools},
               {"slicer", toolpath.slicer},      {"beads", toolpath.beads.size()},
               {"height_mm", highest},           {"filament_mm", toolpath.filament_mm}};
    // As the file states them.
    if (!toolpath.stated.bed.empty()) facts["bed"] = toolpath.stated.bed;
    if (!toolpath.stated.excluded.empty()) facts["excluded"] = toolpath.stated.excluded;
    if (toolpath.stated.seconds) facts["seconds"] = *toolpath.stated.seconds;
    if (toolpath.stated.grams) facts["grams"] = *toolpath.stated.grams;
    if (toolpath.stated.cost) facts["cost"] = *toolpath.stated.cost;
    return facts;
}

}  // namespace

Document::Document(GivenInput given) : given_(std::move(given)), outdated_(given_.objects.empty()) {
    // Below 2^53, so that it is a number of JavaScript.
    std::random_device random;
    generation_ = std::uint64_t{random()} << 20;
}

std::vector<std::string> Document::files() const {
    std::vector<std::string> files =
        assemble::inputFiles(given_.objects, given_.options.scene, given_.options.tracing.prints.print.printer);
    files.push_back(given_.path);
    std::sort(files.begin(), files.end());
    files.erase(std::unique(files.begin(), files.end()), files.end());
    return files;
}

void Document::requireFiles() const {
    for (const std::string& file : files()) {
        std::error_code ignored;
        const auto kind = std::filesystem::status(file, ignored).type();
        if (kind == std::filesystem::file_type::fifo || kind == std::filesystem::file_type::socket ||
            kind == std::filesystem::file_type::character)
            throw InputError(
                fmt::format("{}: is a pipe or a device, which can't be read anew; put a file there", file));
    }
}

void Document::update() {
    if (outdated_ && given_.again) {
        GivenInput now = given_.again();
        now.again = given_.again;
        given_ = std::move(now);
        requireFiles();  // it may name others
    }
    outdated_ = false;
}

void Document::forget() {
    outdated_ = true;
    kept_.forget();
    program_.forget();
    ++generation_;
}

std::shared_ptr<const gcode::Toolpath> Document::toolpath(std::size_t object) const {
    if (object >= given_.objects.size()) return nullptr;
    const assemble::ReadProgram* program = kept_.program(given_.objects[object].vdb, false, false);
    return program == nullptr ? nullptr : program->toolpath;
}

std::shared_ptr<const gcode::Toolpath> Document::timedToolpath(std::size_t object) {
    if (!toolpath(object)) return nullptr;
    requireFiles();
    const std::string& path = given_.objects[object].vdb;
    if (const assemble::ReadProgram* timed = kept_.program(path, true, false)) return timed->toolpath;
    assemble::PrintRequest request = given_.options.tracing.prints;
    request.timed = true;
    request.kept = &kept_;
    const assemble::ReadEvents silent;
    assemble::Warnings ignored(silent);
    return assemble::readProgram(path, request, silent, ignored).toolpath;
}

Json Document::layers() {
    const auto print = timedToolpath(0);
    if (!print) throw InputError("the input has no layers: it is no print");
    std::vector<double> tops(print->layer_count + std::size_t{1}, 0.0);
    for (const gcode::Bead& bead : print->beads) {
        double& top = tops[print->runOf(bead).layer];
        top = std::max({top, static_cast<double>(bead.z0), static_cast<double>(bead.z1)});
    }
    return {{"z", std::move(tops)}, {"seconds", gcode::layerSeconds(*print)}, {"generation", generation_}};
}

Json Document::programAt(std::uint32_t bead) {
    const auto print = toolpath(0);
    if (!print || bead >= print->beads.size()) throw InputError("the message: bead: the print has no such bead");
    const std::uint32_t line = print->lineOf(print->beads[bead]);
    return {{"bead", bead}, {"line", line}, {"lines", linesAround(0, line)}};
}

Json Document::find(const FindMessage& find) {
    const auto print = find.seconds ? timedToolpath(0) : toolpath(0);
    if (!print || print->beads.empty()) throw InputError("the input has no lines to search: it is no print");
    requireFiles();
    Json json = Json::object();
    std::uint32_t line = find.line;
    std::uint32_t bead = 0;
    if (!find.text.empty()) {
        const auto found = program_.find(given_.objects.front().vdb, given_.options.tracing.prints.print, find.text,
                                         find.line, find.back);
        json = {{"matches", found.count}, {"match", found.place}};
        if (found.count == 0) return json;
        line = found.line;
    }
    // Before its first layer nothing of the print is there; the picture then shows where it begins.
    const auto first = std::find_if(print->beads.begin(), print->beads.end(),
                                    [&](const gcode::Bead& each) { return print->runOf(each).layer > 0; });
    if (first != print->beads.end()) bead = static_cast<std::uint32_t>(first - print->beads.begin());
    for (std::uint32_t n = bead; n < print->beads.size(); ++n) {
        const bool before = find.seconds ? static_cast<double>(print->timing[n].start) <= *find.seconds
                                         : print->lineOf(print->beads[n]) <= line;
        if (before) bead = n;
    }
    if (find.seconds && static_cast<double>(print->timing[bead].start) <= *find.seconds)
        line = print->lineOf(print->beads[bead]);
    else if (find.seconds)
        line = print->lineOf(print->beads.front());
    json["lines"] = linesAround(0, line);
    if (json["lines"].empty() || json["lines"].back()["number"] < line)
        throw InputError(fmt::format("the program has no line {}", line));
    json["line"] = line;
    json["bead"] = bead;
    json["layer"] = print->runOf(print->beads[bead]).layer;
    return json;
}

Json Document::linesAround(std::size_t object, std::uint32_t line) {
    requireFiles();
    return program_.around(given_.objects[object].vdb, given_.options.tracing.prints.print, line);
}

Json Document::facts() const {
    Json facts{{"file", std::filesystem::path(given_.path).filename().string()},
               {"path", given_.path},
               {"materials", shade::brdfNames()},
               {"generation", generation_}};
    std::shared_ptr<const gcode::Toolpath> print;
    for (std::size_t n = 0; n < given_.objects.size() && !print; ++n) print = toolpath(n);
    if (print) facts["print"] = factsOf(*print);
    facts["attributes"] = attributesOf(print.get());
    return facts;
}

}  // namespace stratum::view
