#include "study/study.h"

#include "study/cost/own_process.h"
#include "study/cost/times.h"
#include "study/report/page.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>

#include <map>

namespace stratum::study {
namespace {

constexpr const char* kColumns = "family,name,quantity,tolerance,measured,verdict,seconds,why";
constexpr double kMostSeconds = 120;
constexpr const char* kPassed = "passed";
constexpr const char* kFailed = "failed";

Row run(const StabilityCase& test, int threads) {
    const Outcome outcome = inOwnProcess(
        [&] {
            const tbb::global_control limit = limitThreads(threads);
            double measured = 0;
            const double seconds = timesOf([&] { measured = test.measure(); }).wall;
            return csvLine(
                {fmt::format("{:.4g}", measured), verdictOn(test, measured), fmt::format("{:.3f}", seconds)});
        },
        kMostSeconds);
    const Row cells = outcome.failure.empty() ? parseCsvLine(outcome.text) : Row{outcome.failure, kFailed, ""};
    return joined(joined({test.family, test.name, test.quantity, fmt::format("{:.4g}", test.tolerance)}, cells),
                  {test.why});
}

}  // namespace

std::string verdictOn(const StabilityCase& test, double measured) {
    return measured <= test.tolerance ? kPassed : kFailed;
}

std::vector<StabilityCase> stabilityCases() {
    std::vector<StabilityCase> all;
    for (const auto& family : {fieldCases(), rayCases(), lightCases()})
        all.insert(all.end(), family.begin(), family.end());
    return all;
}

StudyReport studyStability(const StudyOptions& common) {
    const std::vector<StabilityCase> cases = stabilityCases();
    Table table(kColumns);
    StudyReport report;
    std::map<std::string, std::vector<Row>> families;
    for (const StabilityCase& test : cases) {
        const Row row = run(test, common.threads);
        table.add(row);
        families[test.family].push_back(row);
        if (table.text(row, "verdict") != kPassed)
            report.findings.push_back(fmt::format("{}, {}: {} is {}, tolerance {:.4g}", test.family, test.name,
                                                  test.quantity, table.text(row, "measured"), test.tolerance));
        common.tell(table.rows().size(), cases.size());
    }
    Page page("Stiff and extreme cases", common.command);
    page.paragraph(fmt::format(
        "{} cases, {} failed. Each measures one quantity, which is 0 at best, against a tolerance that was derived "
        "before measuring; each is a process of its own that may take {:g} s. The same cases run in the tests.",
        cases.size(), report.findings.size(), kMostSeconds));
    for (const auto& [family, rows] : families) {
        page.heading(family);
        page.table(table.columns(), rows, kFailed);
    }
    writeTable(common, "stability", table, report);
    writePage(common, "stability", page, report);
    return report;
}

}  // namespace stratum::study
