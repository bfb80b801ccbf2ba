// Times: what files say of their print beside what the motion planner finds.
#include "study/cost/times.h"
#include "study/deposit/deposit_parts.h"
#include "study/print.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <vector>

namespace stratum::study {
namespace {

constexpr const char* kTimeColumns = "print,sha256,slicer,rule,stated_s,planned_s,off_percent,status";
Row timesOfPrint(const std::string& path) {
    constexpr BeadModel kCommanded{"union", "", [](gcode::ReadOptions&) {}};
    deposit::PrintRead print;
    try {
        print = readByModel(path, kCommanded, true);
    } catch (const InputError& error) {
        // Without the file's folder: the table is read on other machines.
        std::string text = error.what();
        if (const std::size_t at = text.find(path); at != std::string::npos)
            text.replace(at, path.size(), std::filesystem::path(path).filename().string());
        return {"", "", "", "", "", "left out: " + text};
    }
    // As --stats compares them.
    const gcode::StatedFacts& facts = print.toolpath.stated;
    // CuraEngine without Cura, which would fill it in, states the same time for all prints.
    constexpr double kNoTime = 6666;
    const bool filled = !(print.toolpath.slicer.starts_with("Cura") && facts.seconds == kNoTime);
    const motion::StatedTime time = motion::statedTime(*print.times, facts);
    const double stated = filled ? time.stated : 0;
    const double planned = time.planned;
    return {print.toolpath.slicer,
            print.times->rule,
            stated > 0 ? fmt::format("{:.1f}", stated) : "",
            fmt::format("{:.1f}", planned),
            stated > 0 ? fmt::format("{:+.3f}", (planned / stated - 1) * 100) : "",
            stated > 0 ? "ok" : "the file states no time"};
}

}  // namespace

Table studyTimes(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport&) {
    Table table(kTimeColumns);
    std::vector<std::string> files = options.prints;
    files.insert(files.end(), options.timed.begin(), options.timed.end());
    if (files.empty()) return table;
    std::vector<double> sizes;
    Series series{"a file each", {}, false, false};
    for (const std::string& file : files) {
        table.add(joined({std::filesystem::path(file).filename().string(), shortHash(file)}, timesOfPrint(file)));
        const Row& row = table.rows().back();
        if (const double off = table.number(row, "off_percent"); std::isfinite(off)) {
            series.points.emplace_back(table.number(row, "stated_s"), off);
            sizes.push_back(std::abs(off));
        }
        common.tell(table.rows().size(), files.size());
    }
    page.heading("Times");
    page.paragraph(
        "Print times that files state (of the model alone, where they state that apart), and those that the motion "
        "planner of docs/motion.md finds from their moves, their limits and the rule of their firmware. The difference "
        "is the planner's, or the slicer's own rule's: a stated time is an estimate, too.");
    if (!sizes.empty()) {
        page.plot({"Planned against stated", "stated, s", "planned / stated \u2212 1, %", true, false, {series}});
        page.paragraph(
            fmt::format("Of {} files that state a time the median of the sizes is {:.2f} %, the largest {:.1f} %.",
                        sizes.size(), median(sizes), *std::max_element(sizes.begin(), sizes.end())));
    }
    page.table(table);
    return table;
}

}  // namespace stratum::study
