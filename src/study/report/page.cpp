#include "study/report/page.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <thread>

namespace stratum::study {
namespace {

constexpr const char* kStyle = R"(
body{font:15px/1.45 sans-serif;max-width:72em;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;font-size:13px;margin:1em 0;display:block;overflow-x:auto}
th,td{border:1px solid #ccc;padding:2px 8px;text-align:left}td.n{text-align:right;font-variant-numeric:tabular-nums}
th{background:#f2f2f2}tr.marked td{background:#ffd9d0}img,svg{max-width:100%;height:auto}figure{display:inline-block;margin:0 1em 1em 0}footer{color:#666;font-size:13px})";

bool isNumber(const std::string& text) {
    if (text.empty()) return false;
    char* end = nullptr;
    std::strtod(text.c_str(), &end);
    return *end == '\0';
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

std::string withoutFolders(std::span<const std::string> command) {
    std::string text;
    for (const std::string& word : command) {
        const bool folder = word.size() > 1 && word.back() == '/';
        const std::size_t slash = (folder ? word.substr(0, word.size() - 1) : word).rfind('/');
        if (!text.empty()) text += ' ';
        text += slash == std::string::npos ? word : word.substr(slash + 1);
    }
    return text;
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

std::string base64(std::string_view bytes) {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t n = 0; n < bytes.size(); n += 3) {
        std::uint32_t group = 0;
        for (std::size_t i = 0; i < 3; ++i)
            group = group << 8 | (n + i < bytes.size() ? static_cast<std::uint8_t>(bytes[n + i]) : 0U);
        for (std::size_t i = 0; i < 4; ++i) text += n + i <= bytes.size() ? kDigits[group >> (18 - 6 * i) & 63U] : '=';
    }
    return text;
}

Page::Page(std::string title, std::span<const std::string> command) : title_(std::move(title)) {
    made_by_ = fmt::format("<footer><p><code>{}</code><br>\n{:%Y-%m-%d}, vdbstudy {}<br>\n{}</p></footer>\n",
                           report::escapeMarkup(withoutFolders(command)), fmt::gmtime(std::time(nullptr)),
                           STRATUM_VERSION, report::escapeMarkup(machineLine()));
}

void Page::heading(std::string_view text) { body_ += fmt::format("<h2>{}</h2>\n", report::escapeMarkup(text)); }

void Page::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", report::escapeMarkup(text)); }

void Page::table(const Row& columns, const std::vector<Row>& rows, std::string_view marked) {
    body_ += "<table><tr>";
    for (const std::string& cell : columns) body_ += fmt::format("<th>{}</th>", report::escapeMarkup(cell));
    body_ += "</tr>\n";
    for (const Row& row : rows) {
        const bool mark = !marked.empty() && std::find(row.begin(), row.end(), marked) != row.end();
        body_ += mark ? "<tr class='marked'>" : "<tr>";
        for (const std::string& cell : row)
            body_ += fmt::format("<td{}>{}</td>", isNumber(cell) ? " class='n'" : "", report::escapeMarkup(cell));
        body_ += "</tr>\n";
    }
    body_ += "</table>\n";
}

void Page::plot(const Plot& plot) { body_ += "<p>" + report::drawSvg(plot) + "</p>\n"; }

void Page::picture(const std::filesystem::path& png, std::string_view caption) {
    body_ +=
        fmt::format("<figure><img alt='{0}' src='data:image/png;base64,{1}'><figcaption>{0}</figcaption></figure>\n",
                    report::escapeMarkup(caption), base64(MappedFile(png).bytes()));
}

std::string Page::html() const {
    return fmt::format(
        "<!doctype html>\n<html lang='en'><head><meta charset='utf-8'><title>{0}</title>\n<style>{1}</style></head>\n"
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
