#include "view/program_lines.h"

#include "gcode/container/container.h"
#include "gcode/container/input_bytes.h"

#include <algorithm>
#include <string_view>

namespace stratum::view {
namespace {

constexpr std::size_t kMostBytes = 300;

std::string shown(std::string_view line) {
    std::string text(line.substr(0, kMostBytes));
    while (!text.empty() && text.back() == '\r') text.pop_back();
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = c == '\t' ? ' ' : '?';
    return text;
}

}  // namespace

std::vector<ProgramLine> linesAround(const std::string& path, const voxelize::PrintOptions& options,
                                     std::uint32_t number, std::uint32_t around) {
    const gcode::InputBytes file(path, gcode::InputBytes::Streams::refuse);
    const gcode::Program program = gcode::openContainer(file.bytes(), file.name(), options.read.plate);
    const std::uint32_t first = number > around ? number - around : 1;
    std::vector<ProgramLine> lines;
    std::string_view rest = program.text;
    for (std::uint32_t n = 1; n <= number + around && !rest.empty(); ++n) {
        const std::size_t end = rest.find('\n');
        if (n >= first) lines.push_back({n, shown(rest.substr(0, end))});
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
    }
    return lines;
}

nlohmann::json linesAround(const std::string& path, const voxelize::PrintOptions& options, std::uint32_t number) {
    constexpr std::uint32_t kAround = 4;
    nlohmann::json lines = nlohmann::json::array();
    for (const ProgramLine& line : linesAround(path, options, number, kAround))
        lines.push_back({{"number", line.number}, {"text", line.text}});
    return lines;
}

}  // namespace stratum::view
