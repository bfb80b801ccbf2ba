#include "gcode/slicer/truncation.h"

#include "gcode/text/lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace stratum::gcode {
namespace {

constexpr std::size_t kTrailerReach = std::size_t{1} << 18;  // thumbnails and Cura's settings can follow the trailer

struct Trailer {
    std::string_view slicer;
    std::array<std::string_view, 6> any_of;  // texts in the file; one of them is enough; the rest is empty
};

constexpr std::array kTrailers{
    Trailer{"PrusaSlicer", {"; filament used [", "; prusaslicer_config = end", "; filament used = "}},
    Trailer{"SuperSlicer", {"; filament used [", "; SuperSlicer_config = end", "; filament used = "}},
    // Orca for FlashForge has its settings in front
    Trailer{"Orca", {"; filament used [", "; CONFIG_BLOCK_END", "; EXECUTABLE_BLOCK_END", "\nM73 P100"}},
    Trailer{"BambuStudio", {"; EXECUTABLE_BLOCK_END", "; filament end gcode", "; filament used ["}},
    Trailer{"Flash Studio", {"; EXECUTABLE_BLOCK_END", "; CONFIG_BLOCK_END", "; filament used ["}},
    Trailer{"Slic3r", {"; filament used = ", "; filament used [", "; top_solid_layers = "}},
    Trailer{"Cura 15", {}},  // its first versions wrote nothing there
    Trailer{"Cura_SteamEngine 15", {}},
    Trailer{
        "Cura",
        {";End of Gcode", ";SETTING_3 ", ";End of gcode", ";CURA_PROFILE_STRING:", "; End of Gcode", "; SETTING_3 "}},
    Trailer{"Simplify3D", {"; Build Summary", ";   Build time: ", ";   Plastic volume: "}},
    Trailer{"ideaMaker", {";Material#1 Used", ";Print Time: ", ";Material#2 Used"}},
    Trailer{"Kiri:Moto", {"; --- filament used", "; --- print time", ";; --- filament used"}},
};

bool isMove(std::string_view text) {
    Lexer lexer(text);
    Line line;
    if (!lexer.next(line)) return false;
    return line.count > 0 && (line.commands[0].kind == Command::Kind::words ||
                              (line.commands[0].letter == 'G' && line.commands[0].code <= 5));
}

// Whether the line ends inside a word: a command letter without its number, or a parameter letter without the number
// that it needs. "M84 X Y E" and "G28 X" are complete.
bool endsAmidAWord(std::string_view text) {
    const auto last = text.find_last_not_of(" \t");
    if (last == std::string_view::npos || text.find_first_of(";(\"") != std::string_view::npos) return false;
    constexpr std::string_view kCommands = "GMTNgmtn";
    constexpr std::string_view kValues = "SPFRspfr";
    const bool alone = last == 0 || text[last - 1] == ' ';
    if (kCommands.find(text[last]) != std::string_view::npos) return alone;
    return alone && last > 0 && kValues.find(text[last]) != std::string_view::npos &&
           kCommands.find(text.front()) != std::string_view::npos;
}

// Whether any line after the first begins with a motion: some slicers write a trailer's text into their header.
bool moves(std::string_view text) {
    for (auto at = text.find("\nG"); at != std::string_view::npos; at = text.find("\nG", at + 1)) {
        const std::string_view command = text.substr(at + 2, 2);
        if (command.size() == 2 && command[0] >= '0' && command[0] <= '3' && command[1] == ' ') return true;
    }
    return false;
}

}  // namespace

std::string findCut(std::string_view bytes, std::string_view slicer) {
    const std::string_view tail = bytes.substr(bytes.size() - std::min(bytes.size(), kTrailerReach));
    for (const Trailer& trailer : kTrailers) {
        if (slicer.find(trailer.slicer) == std::string_view::npos) continue;
        if (trailer.any_of.front().empty()) break;
        const bool there = std::any_of(trailer.any_of.begin(), trailer.any_of.end(), [tail](std::string_view text) {
            const auto at = text.empty() ? std::string_view::npos : tail.rfind(text);
            return at != std::string_view::npos && !moves(tail.substr(at));
        });
        if (!there) return fmt::format("what {} writes behind a program is missing", trailer.slicer);
        return {};
    }
    if (bytes.empty() || bytes.back() == '\n' || bytes.back() == '\r') return {};
    const auto start = tail.find_last_of("\r\n");
    const std::string_view last_line = start == std::string_view::npos ? tail : tail.substr(start + 1);
    if (isMove(last_line)) return "the last line has no end";
    if (endsAmidAWord(last_line)) return "the last line breaks off amid a word";
    return {};
}

}  // namespace stratum::gcode
