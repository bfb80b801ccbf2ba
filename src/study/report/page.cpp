#include "study/report/page.h"

#include "base/atomic_file.h"
#include "base/base64.h"
#include "base/error.h"
#include "base/input_file.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

namespace stratum::study {
namespace {

// Tables and plots scroll inside themselves: on a phone the page stays as wide as the screen, and letters as large.
constexpr const char* kStyle = R"(
body{font:15px/1.45 sans-serif;max-width:72em;margin:2em auto;padding:0 1em;color:#222;overflow-wrap:anywhere}
table{border-collapse:collapse;font-size:13px;margin:1em 0;display:block;overflow-x:auto;overflow-wrap:normal}
.plot{overflow-x:auto;margin:1em 0}.plot svg{display:block}tr:target td{background:#fff3c0}
th,td{border:1px solid #ccc;padding:2px 8px;text-align:left}td.n{text-align:right;font-variant-numeric:tabular-nums}
th{background:#f2f2f2}tr.marked td{background:#ffd9d0}img{max-width:100%;height:auto}figure{display:inline-block;margin:0 1em 1em 0}footer{color:#666;font-size:13px})";

bool isNumber(const std::string& text) {
    if (text.empty()) return false;
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return *end == '\0';
}

}  // namespace

Page::Page(std::string title, std::span<const std::string> command) : title_(std::move(title)) {
    made_by_ = fmt::format("<footer><p><code>{}</code><br>\n{:%Y-%m-%d}, vdbstudy {}<br>\n{}</p></footer>\n",
                           report::escapeMarkup(shownCommand(command)), fmt::gmtime(std::time(nullptr)),
                           STRATUM_VERSION, report::escapeMarkup(machineLine()));
}

void Page::heading(std::string_view text) { body_ += fmt::format("<h2>{}</h2>\n", report::escapeMarkup(text)); }

void Page::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", report::escapeMarkup(text)); }

void Page::table(const Row& columns, const std::vector<Row>& rows, std::string_view marked,
                 std::span<const std::size_t> lines, std::string_view table) {
    const bool runs = columns.back() == "run";
    const std::string prefix = table.empty() ? std::string("L") : fmt::format("{}-L", table);
    body_ += "<table><tr>";
    for (const std::string& cell : columns) body_ += fmt::format("<th>{}</th>", report::escapeMarkup(cell));
    body_ += "</tr>\n";
    for (std::size_t n = 0; n < rows.size(); ++n) {
        const Row& row = rows[n];
        const bool mark = !marked.empty() && std::find(row.begin(), row.end(), marked) != row.end();
        body_ += mark ? "<tr class='marked'" : "<tr";
        body_ += n < lines.size() ? fmt::format(" id='{}{}'>", prefix, lines[n]) : std::string(">");
        for (std::size_t c = 0; c < row.size(); ++c) {
            const std::string cell = report::escapeMarkup(row[c]);
            const bool link = runs && c + 1 == columns.size() && !cell.empty();
            if (link) runs_.insert(row[c]);
            body_ += fmt::format("<td{}>", isNumber(row[c]) ? " class='n'" : "");
            body_ += link ? fmt::format("<a href='#run-{0}'>{0}</a></td>", cell) : fmt::format("{}</td>", cell);
        }
        body_ += "</tr>\n";
    }
    body_ += "</table>\n";
}

void Page::runs(const ResultTable& table) {
    std::vector<std::string> numbers(runs_.begin(), runs_.end());
    std::sort(numbers.begin(), numbers.end(),
              [](const std::string& a, const std::string& b) { return std::atoi(a.c_str()) < std::atoi(b.c_str()); });
    heading("Runs");
    paragraph("When, where and how the rows were measured, by their last column (runs.csv).");
    body_ += "<table><tr>";
    for (const std::string& cell : RunLog::columns()) body_ += fmt::format("<th>{}</th>", cell);
    body_ += "</tr>\n";
    for (const std::string& number : numbers) {
        const Row* line = table.runs() == nullptr ? nullptr : table.runs()->find(number);
        body_ += fmt::format("<tr id='run-{}'>", report::escapeMarkup(number));
        for (const std::string& cell : line == nullptr ? Row{number} : *line)
            body_ += fmt::format("<td>{}</td>", report::escapeMarkup(cell));
        body_ += "</tr>\n";
    }
    body_ += "</table>\n";
}

void Page::plot(const Plot& plot) { body_ += "<div class='plot'>" + report::drawSvg(plot) + "</div>\n"; }

void Page::picture(const std::filesystem::path& file, std::string_view caption) {
    body_ += fmt::format(
        "<figure><img alt='{0}' src='data:image/{2};base64,{1}'><figcaption>{0}</figcaption></figure>\n",
        report::escapeMarkup(caption), base64Of(InputFile(file).bytes()), file.extension() == ".jpg" ? "jpeg" : "png");
}

std::string Page::html() const {
    return fmt::format(
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
        "content='width=device-width, initial-scale=1'><title>{0}</title>\n<style>{1}</style></head>\n"
        "<body><h1>{0}</h1>\n{2}{3}</body></html>\n",
        report::escapeMarkup(title_), kStyle, body_, made_by_);
}

void Page::write(const std::filesystem::path& path) const {
    AtomicFile file(path);
    std::ofstream stream(file.temporary(), std::ios::binary);
    stream << html();
    stream.close();
    if (!stream) throw writeError(path.string());
    file.commit();
}

}  // namespace stratum::study
