#include "study/report/table.h"

#include "base/atomic_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace stratum::study {

Table::Table(std::string_view columns) : columns_(parseCsvLine(columns)) {}

void Table::add(Row row) {
    assert(row.size() == columns_.size());
    rows_.push_back(std::move(row));
}

const std::string& Table::text(const Row& row, std::string_view column) const {
    const auto found = std::find(columns_.begin(), columns_.end(), column);
    return row.at(static_cast<std::size_t>(found - columns_.begin()));
}

double Table::number(const Row& row, std::string_view column) const {
    const std::string& cell = text(row, column);
    return cell.empty() ? std::numeric_limits<double>::quiet_NaN() : std::atof(cell.c_str());
}

void Table::write(const std::filesystem::path& path) const {
    // By this mark the next study knows that it may replace the file.
    std::string text = csvLine(joined(columns_, {"made_by"}));
    for (const Row& row : rows_) text += csvLine(joined(row, {"vdbstudy " STRATUM_VERSION}));
    writeFile(path, text);
}

std::string figure(double value) {
    if (std::isnan(value)) return {};
    const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
    return whole ? fmt::format("{:.0f}", value) : fmt::format("{:.5g}", value);
}

Row figures(std::initializer_list<double> values) {
    Row row;
    for (const double value : values) row.push_back(figure(value));
    return row;
}

Row joined(Row first, const Row& second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

std::string csvLine(const Row& row) {
    std::string line;
    for (std::size_t n = 0; n < row.size(); ++n) {
        if (n > 0) line += ',';
        if (row[n].find_first_of(",\"\n") == std::string::npos) {
            line += row[n];
            continue;
        }
        line += '"';
        for (const char c : row[n]) line += c == '"' ? std::string("\"\"") : std::string(1, c);
        line += '"';
    }
    return line + '\n';
}

Row parseCsvLine(std::string_view line) {
    if (line.ends_with('\n')) line.remove_suffix(1);
    Row row(1);
    bool quoted = false;
    for (std::size_t n = 0; n < line.size(); ++n) {
        const char c = line[n];
        if (quoted && c == '"' && n + 1 < line.size() && line[n + 1] == '"')
            row.back() += line[++n];
        else if (c == '"')
            quoted = !quoted;
        else if (c == ',' && !quoted)
            row.emplace_back();
        else
            row.back() += c;
    }
    return row;
}

}  // namespace stratum::study
