// A report as a file: .json for programs, .md and .html for people.
#pragma once

#include "report/print_report.h"

#include <filesystem>
#include <string>

namespace stratum::report {

/// Whether the name ends in .json, .md or .html; also "-.json" and its like, standard output.
bool isReportPath(const std::filesystem::path& path);

std::string reportMarkdown(const PrintReport& report);
/// One page that needs no other file; for wide and narrow screens, light and dark.
std::string reportPage(const PrintReport& report);

/// Appears whole or not at all. Throws UsageError for another name, OutputError.
void writeReport(const PrintReport& report, const std::filesystem::path& path);

}  // namespace stratum::report
