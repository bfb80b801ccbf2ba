// Times: what files say of their print beside what the motion planner finds.
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

const Row kTimeColumns{"print", "sha256", "slicer", "rule", "stated_s", "planned_s", "off_percent", "status"};
constexpr std::size_t kTimeKeys = 2;
enum TimeColumn : std::size_t {
    kTimePrint,
    kTimeHash,
    kTimeSlicer,
    kTimeRule,
    kTimeStated,
    kTimePlanned,
    kTimeOff,
    kTimeStatus
};

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

void writeTimes(Page& page, const ResultTable& table) {
    page.heading("Times");
    page.paragraph(
        "Print times that files state (of the model alone, where they state that apart), and those that the motion "
        "planner of docs/motion.md finds from their moves, their limits and the rule of their firmware. The difference "
        "is the planner's, or the slicer's own rule's: a stated time is an estimate, too.");
    std::vector<double> sizes;
    Plot plot{"Planned against stated", "stated, s", "planned / stated \u2212 1, %", true, false, {}};
    Series series{"a file each", {}, false, false};
    std::vector<Row> cells;
    std::vector<std::size_t> lines;
    for (const Row& row : table.rows()) {
        if (row[kTimeStatus] == "ok") {
            series.points.emplace_back(numberIn(row, kTimeStated), numberIn(row, kTimeOff));
            sizes.push_back(std::abs(numberIn(row, kTimeOff)));
        }
        cells.push_back({row[kTimePrint], row[kTimeSlicer], row[kTimeRule], row[kTimeStated], row[kTimePlanned],
                         row[kTimeOff].empty() ? row[kTimeStatus] : fmt::format("{:+.2f}", numberIn(row, kTimeOff)),
                         row.back()});
        lines.push_back(table.lineOf(row));
    }
    if (!sizes.empty()) {
        std::sort(sizes.begin(), sizes.end());
        plot.series.push_back(std::move(series));
        page.plot(plot);
        page.paragraph(
            fmt::format("Of {} files that state a time the median of the sizes is {:.2f} %, the largest "
                        "{:.1f} %.",
                        sizes.size(), sizes[sizes.size() / 2], sizes.back()));
    }
    page.table({"print", "slicer", "rule", "stated s", "planned s", "off %", "run"}, cells, {}, lines, "deposit_time");
}

}  // namespace

PartTable studyTimes(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport&) {
    auto table = std::make_unique<ResultTable>(common, "deposit_time.csv", kTimeColumns, kTimeKeys);
    std::vector<std::string> files = options.prints;
    files.insert(files.end(), options.timed.begin(), options.timed.end());
    for (std::size_t n = 0; n < files.size(); ++n) {
        Row row{std::filesystem::path(files[n]).filename().string(), shortHash(files[n])};
        if (table->find(row) == nullptr) {
            const Row cells = timesOfPrint(files[n]);
            row.insert(row.end(), cells.begin(), cells.end());
            table->add(std::move(row));
        }
        if (common.progress) common.progress(static_cast<double>(n + 1) / static_cast<double>(files.size()));
    }
    if (!table->rows().empty()) writeTimes(page, *table);
    return table;
}

}  // namespace stratum::study
