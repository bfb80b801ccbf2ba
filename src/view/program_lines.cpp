#include "view/program_lines.h"

#include <algorithm>
#include <string_view>
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

std::vector<ProgramLine> KeptProgram::around(const std::string& path, const voxelize::PrintOptions& options,
                                             std::uint32_t number, std::uint32_t around) {
    if (text_ == nullptr || text_->path() != path) {
        text_.reset();
        text_ = std::make_unique<ProgramText>(path, options);
    }
    std::vector<ProgramLine> lines = text_->around(number, around);
    if (text_->bytes() > most_bytes_) text_.reset();
    return lines;
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
