#include "study/report/result_table.h"

#include "base/error.h"
#include "study/report/run_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace stratum::study {
namespace {

// The rows of whole lines. `whole` is how many bytes they take: what follows was cut short.
std::vector<Row> parse(std::string_view text, std::size_t& whole) {
    std::vector<Row> rows;
    Row row;
    std::string cell;
    bool quoted = false;
    whole = 0;
    for (std::size_t n = 0; n < text.size(); ++n) {
        const char c = text[n];
        if (quoted) {
            if (c != '"')
                cell += c;
            else if (n + 1 < text.size() && text[n + 1] == '"')
                cell += text[++n];
            else
                quoted = false;
        } else if (c == '"') {
            quoted = true;
        } else if (c == ',' || c == '\n') {
            row.push_back(std::move(cell));
            cell.clear();
            if (c == ',') continue;
            rows.push_back(std::move(row));
            row.clear();
            whole = n + 1;
        } else {
            cell += c;
        }
    }
    return rows;
}

std::size_t linesOf(const Row& row) {
    std::size_t lines = 1;
    for (const std::string& cell : row) lines += static_cast<std::size_t>(std::count(cell.begin(), cell.end(), '\n'));
    return lines;
}

Row withRun(Row columns) {
    columns.emplace_back("run");
    return columns;
}

}  // namespace

double numberIn(const Row& row, std::size_t column) { return std::atof(row[column].c_str()); }

std::string csvLine(const Row& row) {
    std::string line;
    for (std::size_t n = 0; n < row.size(); ++n) {
        if (n > 0) line += ',';
        if (row[n].find_first_of(",\"\n") == std::string::npos) {
            line += row[n];
            continue;
        }
        line += '"';
        for (const char c : row[n]) {
            if (c == '"') line += '"';
            line += c;
        }
        line += '"';
    }
    return line + '\n';
}

Row parseCsvLine(std::string_view line) {
    std::size_t whole = 0;
    const std::string text = line.ends_with('\n') ? std::string(line) : std::string(line) + '\n';
    return parse(text, whole).at(0);
}

ResultTable::ResultTable(std::filesystem::path path, Row columns, std::size_t key_columns, bool fresh)
    : path_(std::move(path)), columns_(std::move(columns)), key_columns_(key_columns) {
    std::string text;
    if (!fresh) {
        std::ifstream file(path_, std::ios::binary);
        std::stringstream bytes;
        if (file) bytes << file.rdbuf();
        text = bytes.str();
    }
    std::size_t whole = 0;
    std::vector<Row> rows = parse(text, whole);
    if (!rows.empty() && rows.front() != columns_)
        throw UsageError(fmt::format(
            "{}: holds other columns than this study's; move it away, or start over with --fresh", path_.string()));
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0 || ::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0)
        throw OutputError(fmt::format("{}: can't be written; check the folder", path_.string()));
    next_line_ += linesOf(columns_);
    if (rows.empty()) {
        write(csvLine(columns_));
        return;
    }
    for (std::size_t n = 1; n < rows.size(); ++n) {
        if (rows[n].size() != columns_.size())
            throw UsageError(fmt::format("{}:{}: {} cells where {} were expected; mend it, or start over with --fresh",
                                         path_.string(), n + 1, rows[n].size(), columns_.size()));
        keep(std::move(rows[n]));
    }
    resumed_ = rows_.size();
}

ResultTable::ResultTable(const StudyOptions& common, const std::string& file, Row columns, std::size_t key_columns)
    : ResultTable(common.folder / file, withRun(std::move(columns)), key_columns, common.fresh) {
    runs_ = std::make_unique<RunLog>(common.folder, common.command);
}

ResultTable::~ResultTable() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::string ResultTable::keyOf(const Row& row) const {
    return csvLine({row.begin(), row.begin() + static_cast<std::ptrdiff_t>(key_columns_)});
}

const Row* ResultTable::find(const Row& key) const {
    const auto found = index_.find(keyOf(key));
    return found == index_.end() ? nullptr : &rows_[found->second];
}

void ResultTable::add(Row row) {
    if (runs_) row.push_back(runs_->number());
    assert(row.size() == columns_.size());
    write(csvLine(row));
    keep(std::move(row));
}

void ResultTable::keep(Row row) {
    index_[keyOf(row)] = rows_.size();
    lines_.push_back(next_line_);
    next_line_ += linesOf(row);
    rows_.push_back(std::move(row));
}

std::size_t ResultTable::lineOf(const Row& key) const {
    const auto found = index_.find(keyOf(key));
    return found == index_.end() ? 0 : lines_[found->second];
}

void ResultTable::write(std::string_view text) {
    // One call: a kill leaves the line whole, or cut short at the end of the file, never mixed.
    if (::write(descriptor_, text.data(), text.size()) != static_cast<ssize_t>(text.size()) ||
        ::fsync(descriptor_) != 0)
        throw writeError(path_.string());
}

}  // namespace stratum::study
