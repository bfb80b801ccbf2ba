// When, on which machine and by which command the rows of a study's tables were measured.
#pragma once

#include "study/report/result_table.h"

#include <filesystem>
#include <span>
#include <string>

namespace stratum::study {

/// Processor, cores, memory, system, compiler; never the machine's name.
std::string machineLine();

/// What was typed, without the names of folders: it is read on other machines.
std::string shownCommand(std::span<const std::string> command);

/// runs.csv of a folder: the last column of its tables, "run", has the number of one of its lines. One process at a
/// time.
class RunLog {
public:
    /// Opens or makes the file. Throws UsageError, OutputError as ResultTable does.
    RunLog(const std::filesystem::path& folder, std::span<const std::string> command);

    /// The number of this run. Its line is written with the first row that was measured, so that a run that finds all
    /// rows there leaves none. Tables of one process share it.
    const std::string& number();
    /// Columns of runs.csv.
    static const Row& columns();
    /// The line of a run, or null.
    const Row* find(const std::string& number) const { return table_.find({number}); }

private:
    ResultTable table_;
    std::string command_;
    std::string number_;
};

}  // namespace stratum::study
