// Rows of measurements in a CSV file that grows as they are made, so that a killed study goes on where it was.
#pragma once

#include "study/study.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace stratum::study {

using Row = std::vector<std::string>;

class RunLog;

/// A cell as a number; 0 if it is empty.
double numberIn(const Row& row, std::size_t column);

/// A CSV file (RFC 4180) whose first columns are the key of a row. Each row is appended by one write and flushed to the
/// disk before add() returns; what a crash left of a last line is cut off at the next start. One thread, one process.
class ResultTable {
public:
    /// Opens or makes the file, and reads the rows that it has. `fresh` forgets them. Throws UsageError if it has other
    /// columns: it is from another study, or another version of this one; OutputError if it can't be written.
    ResultTable(std::filesystem::path path, Row columns, std::size_t key_columns, bool fresh = false);
    /// A table of a study, in its folder. One column more, "run", says in which run of runs.csv (run_log.h) each row
    /// was measured; add() fills it in.
    ResultTable(const StudyOptions& common, const std::string& file, Row columns, std::size_t key_columns);
    ~ResultTable();
    ResultTable(const ResultTable&) = delete;
    ResultTable& operator=(const ResultTable&) = delete;

    /// The row with these key cells, or null.
    const Row* find(const Row& key) const;
    /// Appends a row with as many cells as there are columns (less that of the run). Throws OutputError.
    void add(Row row);

    const Row& columns() const { return columns_; }
    const std::vector<Row>& rows() const { return rows_; }
    /// Rows that were there before.
    std::size_t resumed() const { return resumed_; }
    const std::filesystem::path& path() const { return path_; }
    /// The line of the file, counted from 1, on which the row with these key cells begins; 0 if there is none.
    std::size_t lineOf(const Row& key) const;
    /// Null of a table without runs.
    const RunLog* runs() const { return runs_.get(); }

private:
    std::string keyOf(const Row& row) const;
    void keep(Row row);
    void write(std::string_view text);

    std::filesystem::path path_;
    Row columns_;
    std::size_t key_columns_;
    std::vector<Row> rows_;
    std::unordered_map<std::string, std::size_t> index_;
    std::vector<std::size_t> lines_;  // of the file, on which the rows begin
    std::size_t next_line_ = 1;
    std::size_t resumed_ = 0;
    std::unique_ptr<RunLog> runs_;
    int descriptor_ = -1;
};

/// One line of CSV with its line end.
std::string csvLine(const Row& row);
/// The cells of one line, with or without its line end.
Row parseCsvLine(std::string_view line);

}  // namespace stratum::study
