#include "study/stability/stability.h"

#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/report/page.h"
#include "study/report/result_table.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <cmath>
#include <map>

namespace stratum::study {
namespace {

const Row kColumns{"family", "name", "quantity", "tolerance", "measured", "verdict", "seconds", "why"};
constexpr std::size_t kKeys = 2;
enum Column : std::size_t { kFamily, kName, kQuantity, kTolerance, kMeasured, kVerdict, kSeconds, kWhy };
constexpr double kMostSeconds = 120;
constexpr const char* kPassed = "passed";
constexpr const char* kFailed = "failed";

Row run(const StabilityCase& test, int threads) {
    const Outcome outcome = inOwnProcess(
        [&] {
            const tbb::global_control limit(
                tbb::global_control::max_allowed_parallelism,
                static_cast<std::size_t>(threads > 0 ? threads : tbb::info::default_concurrency()));
            double measured = 0;
            const double seconds = timesOf([&] { measured = test.measure(); }).wall;
            return fmt::format("{:.4g},{},{:.3f}", measured, verdictOn(test, measured), seconds);
        },
        kMostSeconds);
    Row cells{outcome.failure, kFailed, ""};
    if (outcome.failure.empty()) cells = parseCsvLine(outcome.text);
    return {test.family, test.name, test.quantity, fmt::format("{:.4g}", test.tolerance),
            cells[0],    cells[1],  cells[2],      test.why};
}

}  // namespace

std::string verdictOn(const StabilityCase& test, double measured) {
    return measured <= test.tolerance ? kPassed : kFailed;
}

std::vector<StabilityCase> stabilityCases() {
    std::vector<StabilityCase> all;
    for (const auto& family : {toolpathCases(), gridCases(), rayCases(), lightCases(), motionCases(), flowCases(),
                               shardCases(), viewerCases()})
        all.insert(all.end(), family.begin(), family.end());
    return all;
}

StudyReport studyStability(const StudyOptions& common) {
    const std::vector<StabilityCase> cases = stabilityCases();
    ResultTable table(common, "stability.csv", kColumns, kKeys);
    StudyReport report;
    struct Family {
        std::vector<Row> rows;
        std::vector<std::size_t> lines;
    };
    std::map<std::string, Family> families;
    for (const StabilityCase& test : cases) {
        if (table.find({test.family, test.name}) == nullptr) table.add(run(test, common.threads));
        const Row& row = *table.find({test.family, test.name});
        families[test.family].rows.push_back(row);
        families[test.family].lines.push_back(table.lineOf(row));
        if (row[kVerdict] != kPassed)
            report.findings.push_back(fmt::format("{}, {}: {} is {}, tolerance {}", row[kFamily], row[kName],
                                                  row[kQuantity], row[kMeasured], row[kTolerance]));
        if (common.progress)
            common.progress(static_cast<double>(table.rows().size()) / static_cast<double>(cases.size()));
    }
    report.csv = table.path();
    report.html = common.folder / "stability.html";
    report.rows = table.rows().size();
    report.resumed = table.resumed();
    Page page("Stiff and extreme cases", common.command);
    page.paragraph(fmt::format(
        "{} cases, {} failed. Each measures one quantity, which is 0 at best, against a tolerance that was derived "
        "before measuring; each is a process of its own that may take {:g} s. The same cases run in the tests.",
        cases.size(), report.findings.size(), kMostSeconds));
    for (const auto& [family, cases_of] : families) {
        page.heading(family);
        page.table(table.columns(), cases_of.rows, kFailed, cases_of.lines, "stability");
    }
    page.runs(table);
    page.write(report.html);
    return report;
}

}  // namespace stratum::study
