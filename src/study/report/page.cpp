#include "study/report/page.h"

#include "base/atomic_file.h"
#include "base/text.h"
#include "report/text/html_page.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

namespace stratum::study {
namespace {

constexpr const char* kStyle = R"(
h1{margin-bottom:1rem}th,td{text-align:left}td.n{text-align:right}tr.marked td{color:var(--warn);font-weight:600}
.plot{overflow-x:auto;margin:1em 0}.plot svg{display:block}
img{max-width:100%;height:auto}figure{display:inline-block;margin:0 1em 1em 0})";

bool isNumber(const std::string& text) {
    if (text.empty()) return false;
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return *end == '\0';
}

// What was typed, without the names of folders.
std::string shownCommand(std::span<const std::string> command) {
    std::string text;
    for (const std::string& word : command) {
        const bool folder = word.size() > 1 && word.back() == '/';
        const std::size_t slash = (folder ? word.substr(0, word.size() - 1) : word).rfind('/');
        if (!text.empty()) text += ' ';
        text += slash == std::string::npos ? word : word.substr(slash + 1);
    }
    return text;
}

// The value of a "key : value" line of a system file.
std::string valueIn(const char* file, std::string_view key) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.rfind(key, 0) != 0) continue;
        const std::size_t at = line.find_first_of(":=");
        if (at == std::string::npos) continue;
        return std::string(trim(std::string_view(line).substr(at + 1), " \t\""));
    }
    return {};
}

}  // namespace

std::string machineLine() {
    const std::string processor = valueIn("/proc/cpuinfo", "model name");
    const double memory = std::atof(valueIn("/proc/meminfo", "MemTotal").c_str()) * 1024e-9;
    const std::string system = valueIn("/etc/os-release", "PRETTY_NAME");
    return fmt::format("{}, {} threads, {:.0f} GB of memory, {}, compiler {}",
                       processor.empty() ? "unknown processor" : processor, std::thread::hardware_concurrency(), memory,
                       system.empty() ? "unknown system" : system, __VERSION__);
}

Page::Page(std::string title, std::span<const std::string> command) : title_(std::move(title)) {
    made_by_ = fmt::format("<p class='soft'><code>{}</code><br>\n{:%Y-%m-%d %H:%M} UTC, vdbstudy {}<br>\n{}</p>\n",
                           report::escapeMarkup(shownCommand(command)), fmt::gmtime(std::time(nullptr)),
                           STRATUM_VERSION, report::escapeMarkup(machineLine()));
}

void Page::heading(std::string_view text) { body_ += fmt::format("<h2>{}</h2>\n", report::escapeMarkup(text)); }

void Page::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", report::escapeMarkup(text)); }

void Page::table(const Row& columns, const std::vector<Row>& rows, std::string_view marked) {
    body_ += "<div class='scroll'><table><tr>";
    for (const std::string& cell : columns) body_ += fmt::format("<th>{}</th>", report::escapeMarkup(cell));
    body_ += "</tr>\n";
    for (const Row& row : rows) {
        const bool mark = !marked.empty() && std::find(row.begin(), row.end(), marked) != row.end();
        body_ += mark ? "<tr class='marked'>" : "<tr>";
        for (const std::string& cell : row)
            body_ += fmt::format("<td{}>{}</td>", isNumber(cell) ? " class='n'" : "", report::escapeMarkup(cell));
        body_ += "</tr>\n";
    }
    body_ += "</table></div>\n";
}

void Page::plot(const Plot& plot) { body_ += "<div class='plot'>" + report::drawSvg(plot) + "</div>\n"; }

void Page::picture(std::string_view jpeg, std::string_view caption) {
    body_ +=
        fmt::format("<figure><img alt='{0}' src='data:image/jpeg;base64,{1}'><figcaption>{0}</figcaption></figure>\n",
                    report::escapeMarkup(caption), jpeg);
}

std::string Page::html() const { return report::htmlPage(title_, body_ + made_by_, kStyle); }

void writePage(const StudyOptions& common, const std::string& name, const Page& page, StudyReport& report) {
    report.html = common.folder / (name + ".html");
    writeFile(report.html, page.html());
}

void writeTable(const StudyOptions& common, const std::string& name, const Table& table, StudyReport& report) {
    report.csv = common.folder / (name + ".csv");
    table.write(report.csv);
    report.rows += table.rows().size();
}

}  // namespace stratum::study
