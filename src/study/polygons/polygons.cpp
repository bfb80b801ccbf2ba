#include "study/polygons/polygons.h"

#include "base/error.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <algorithm>
#include <filesystem>

namespace stratum::study {
namespace {

namespace fs = std::filesystem;

// Files as they are; of folders, their G-code by name.
std::vector<std::string> filesOf(const std::vector<std::string>& prints) {
    std::vector<std::string> files;
    for (const std::string& print : prints) {
        if (!fs::is_directory(print)) {
            files.push_back(print);
            continue;
        }
        const std::size_t before = files.size();
        for (const auto& entry : fs::directory_iterator(print))
            if (entry.path().extension() == ".gcode") files.push_back(entry.path().string());
        if (files.size() == before) throw InputError(fmt::format("{}: holds no .gcode; slice some models", print));
        std::sort(files.begin() + static_cast<std::ptrdiff_t>(before), files.end());
    }
    return files;
}

}  // namespace

StudyReport studyPolygons(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common) {
    openvdb::initialize();
    if (options.scenes.empty() && options.prints.empty())
        throw UsageError("nothing to study: name --scenes, or prints, or both");
    PolygonsOptions given = options;
    given.prints = filesOf(options.prints);
    StudyReport report;
    Page page("Level sets beside polygons and beads", common.command);
    // Prints first: each is measured in a process of its own, which wants no threads to have been started before.
    if (!given.prints.empty())
        writeTable(common, "polygons_prints", studyPrints(given, peers, common, page, report), report);
    if (!given.scenes.empty())
        writeTable(common, "polygons_scenes", studyScenes(given, peers, common, page, report), report);
    writePage(common, "polygons", page, report);
    return report;
}

}  // namespace stratum::study
