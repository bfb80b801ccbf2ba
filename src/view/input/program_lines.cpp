#include "view/input/program_lines.h"

#include <algorithm>
#include <functional>
#include <string_view>
#include <tuple>
#include <utility>

namespace stratum::view {
namespace {

constexpr std::size_t kMostShown = 300;  // bytes
constexpr std::size_t kLinesAMark = 1024;

std::string shown(std::string_view line) {
    std::string text(line.substr(0, kMostShown));
    while (!text.empty() && text.back() == '\r') text.pop_back();
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = c == '\t' ? ' ' : '?';
    return text;
}

char small(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; }

}  // namespace

ProgramText::ProgramText(const std::string& path, const voxelize::PrintOptions& options)
    : path_(path),
      file_(std::in_place, path, gcode::InputBytes::Streams::refuse),
      program_(gcode::openContainer(file_->bytes(), file_->name(), options.read.plate)) {
    if (program_.unpacked.size() > 0) file_.reset();
    const std::string_view text = program_.text;
    std::size_t line = 0;
    for (std::size_t begin = 0; begin < text.size(); ++line) {
        if (line % kLinesAMark == 0) marks_.push_back(begin);
        const std::size_t end = text.find('\n', begin);
        if (end == std::string_view::npos) break;
        begin = end + 1;
    }
}

std::vector<ProgramLine> ProgramText::around(std::uint32_t number, std::uint32_t around) const {
    const std::uint32_t first = number > around ? number - around : 1;
    const std::size_t mark = (first - 1) / kLinesAMark;
    std::vector<ProgramLine> lines;
    if (mark >= marks_.size()) return lines;
    std::string_view rest = program_.text.substr(marks_[mark]);
    for (std::size_t n = mark * kLinesAMark + 1; n <= std::size_t{number} + around && !rest.empty(); ++n) {
        const std::size_t end = rest.find('\n');
        if (n >= first) lines.push_back({static_cast<std::uint32_t>(n), shown(rest.substr(0, end))});
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
    }
    return lines;
}

ProgramText::Found ProgramText::find(std::string_view text, std::uint32_t line, bool back) const {
    const auto equal = [](char a, char b) { return small(a) == small(b); };
    const auto hash = [](char c) { return std::hash<char>()(small(c)); };
    const std::boyer_moore_horspool_searcher searcher(text.begin(), text.end(), hash, equal);
    const std::string_view all = program_.text;
    Found found, last;
    std::uint32_t number = 1;  // of the line where `next` is
    auto next = all.begin();
    for (auto at = std::search(next, all.end(), searcher); at != all.end();
         at = std::search(next, all.end(), searcher)) {
        number += static_cast<std::uint32_t>(std::count(next, at, '\n'));
        last = {number, ++found.count, 0};
        const bool wanted = back ? number < line : number > line && found.line <= line;
        if (wanted || (!back && found.count == 1)) std::tie(found.line, found.place) = std::pair(number, found.count);
        next = std::find(at, all.end(), '\n');  // each line counts once
    }
    if (back && found.line == 0) std::tie(found.line, found.place) = std::pair(last.line, last.place);
    return found;
}

std::vector<ProgramLine> KeptProgram::around(const std::string& path, const voxelize::PrintOptions& options,
                                             std::uint32_t number, std::uint32_t around) {
    std::vector<ProgramLine> lines = textOf(path, options).around(number, around);
    leave();
    return lines;
}

ProgramText::Found KeptProgram::find(const std::string& path, const voxelize::PrintOptions& options,
                                     std::string_view text, std::uint32_t line, bool back) {
    const ProgramText::Found found = textOf(path, options).find(text, line, back);
    leave();
    return found;
}

const ProgramText& KeptProgram::textOf(const std::string& path, const voxelize::PrintOptions& options) {
    if (text_ == nullptr || text_->path() != path) {
        text_.reset();
        text_ = std::make_unique<ProgramText>(path, options);
    }
    return *text_;
}

void KeptProgram::leave() {
    if (text_->bytes() > most_bytes_) text_.reset();
}

nlohmann::json KeptProgram::around(const std::string& path, const voxelize::PrintOptions& options,
                                   std::uint32_t number) {
    constexpr std::uint32_t kAround = 4;
    nlohmann::json lines = nlohmann::json::array();
    for (const ProgramLine& line : around(path, options, number, kAround))
        lines.push_back({{"number", line.number}, {"text", line.text}});
    return lines;
}

}  // namespace stratum::view
