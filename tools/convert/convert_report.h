// gcode2vdb --report: its options, and the files that it writes.
#pragma once

#include "run_files.h"

#include "report/print_report.h"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace stratum::tools {

/// As the command line gives it.
struct ConvertReport {
    std::vector<std::string> paths;  // empty: no report
    std::optional<double> density;   // g/cm^3
    std::optional<double> price;     // of a kg

    bool asked() const { return !paths.empty(); }
    bool onStandardOutput() const;
};

void addReportOptions(CLI::App& app, ConvertReport& report);

/// Throws UsageError for names of another kind, several inputs and an output of elements; OutputError if a file can't
/// be written: before the work. `files` learns of them.
void checkReport(const ConvertReport& report, std::size_t inputs, const std::string& output, RunFiles& files);

/// Throws OutputError.
void writeReports(const ConvertReport& asked, const report::PrintReport& report);

}  // namespace stratum::tools
