#include "convert/convert_report.h"

#include "base/error.h"
#include "report/text/report_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::tools {

bool ConvertReport::onStandardOutput() const {
    return std::any_of(paths.begin(), paths.end(), [](const std::string& path) { return isStandardOutput(path); });
}

void addReportOptions(CLI::App& app, ConvertReport& report) {
    const char* group = "Report";
    auto* asked =
        app.add_option("--report", report.paths,
                       "Numbers of the print with their definitions: mass, balance, porosity, walls, roughness, "
                       "overhangs, bonding. A .json, .md or .html; may be given several times. Without -o no "
                       ".vdb is written")
            ->type_name("FILE")
            ->expected(1)
            ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
            ->group(group);
    app.add_option("--density", report.density, "Of the filament, g/cm3 (default: the file's)")
        ->check(CLI::Range(0.01, 25.0))
        ->type_name("G_CM3")
        ->needs(asked)
        ->group(group);
    app.add_option("--price", report.price, "Of a kg of filament (default: the file's)")
        ->check(CLI::Range(0.0, 1e9))
        ->type_name("PER_KG")
        ->needs(asked)
        ->group(group);
}

void checkReport(const ConvertReport& report, std::size_t inputs, const std::string& output, RunFiles& files) {
    if (!report.asked()) return;
    if (inputs > 1) throw UsageError("--report takes one input; run once for each");
    if (output.ends_with(".inp"))
        throw UsageError(fmt::format("--report measures a level set, and {} has none; run once for each", output));
    for (const std::string& path : report.paths) {
        if (!report::isReportPath(path))
            throw UsageError(fmt::format("--report {}: the name must end in .json, .md or .html", path));
        files.writesBeside(path, "--report");
    }
}

void writeReports(const ConvertReport& asked, const report::PrintReport& report) {
    for (const std::string& path : asked.paths) report::writeReport(report, path);
}

}  // namespace stratum::tools
