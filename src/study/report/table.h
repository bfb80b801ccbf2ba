// Rows of measurements under named columns: one CSV file.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::study {

using Row = std::vector<std::string>;

class Table {
public:
    /// `columns`: their names, with commas between.
    explicit Table(std::string_view columns);

    /// As many cells as there are columns.
    void add(Row row);
    const Row& columns() const { return columns_; }
    const std::vector<Row>& rows() const { return rows_; }
    /// The cell of a row in the column of this name.
    const std::string& text(const Row& row, std::string_view column) const;
    /// The same as a number; NaN if it is empty.
    double number(const Row& row, std::string_view column) const;
    /// A CSV file (RFC 4180), with the program and its version as one column more. Throws OutputError.
    void write(const std::filesystem::path& path) const;

private:
    Row columns_;
    std::vector<Row> rows_;
};

/// Five digits of a number, all of a whole one, nothing of a NaN.
std::string figure(double value);
/// Of each number its figure.
Row figures(std::initializer_list<double> values);
Row joined(Row first, const Row& second);

/// One line of CSV with its line end.
std::string csvLine(const Row& row);
/// The cells of one line, with or without its line end.
Row parseCsvLine(std::string_view line);

}  // namespace stratum::study
