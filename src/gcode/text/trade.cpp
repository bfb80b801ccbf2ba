#include "gcode/text/trade.h"

#include "base/text.h"
#include "gcode/text/lexer.h"

#include <fmt/format.h>

#include <cstddef>

namespace stratum::gcode {
namespace {

constexpr std::size_t kTradeReach = std::size_t{1} << 18;

struct Signs {
    std::size_t starts = 0;   // of spindles and lasers: M3, M4
    std::size_t burns = 0;    // moves with a power
    std::size_t mills = 0;    // drilling cycles, lengths and changes of cutters
    std::size_t pens = 0;     // servos
    std::size_t plunges = 0;  // moves below z = 0
    std::size_t tool_changes = 0;
    std::size_t prints = 0;  // commands that only printers have
    bool relative = false;
    bool says_laser = false;
    bool says_pen = false;
};

bool says(std::string_view lower_text, std::string_view word) { return lower_text.find(word) != lower_text.npos; }

void addWords(std::string_view comment, Signs& signs) {
    const std::string text = lowerCase(std::string(comment.substr(0, 200)));
    signs.says_laser = signs.says_laser || says(text, "laser") || says(text, "lightburn");
    signs.says_pen = signs.says_pen || says(text, "pen up") || says(text, "pen down") || says(text, "plotter");
    if (says(text, "endmill") || says(text, "end mill") || says(text, "spindle") || says(text, "cutter")) ++signs.mills;
}

bool goesDown(const Command& command, const Signs& signs) {
    return !signs.relative && command.hasValue('Z') && command.value('Z') < 0;
}

void addCommand(const Command& command, Signs& signs) {
    if (command.letter == 'M') {
        if (command.code == 3 || command.code == 4) ++signs.starts;
        if (command.code == 6) ++signs.tool_changes;
        if (command.code == 104 || command.code == 109 || command.code == 140) ++signs.prints;
        if (command.code == 280) ++signs.pens;
    } else if (command.letter == 'G') {
        if (command.code == 90 || command.code == 91) signs.relative = command.code == 91;
        if (command.code == 161 || command.code == 162) ++signs.prints;  // MakerBot's homing
        if (command.code == 43 || (command.code >= 81 && command.code <= 89)) ++signs.mills;
        if (command.code <= 3 && command.hasValue('S')) ++signs.burns;
        if (command.code <= 3 && goesDown(command, signs)) ++signs.plunges;
    } else if (command.kind == Command::Kind::words && goesDown(command, signs)) {
        ++signs.plunges;
    }
}

// "{first_layer_temperature[0]}" or "[layer_num]" in a line's commands; empty if there is none.
std::string_view placeholderIn(std::string_view line) {
    line = line.substr(0, line.find_first_of(";("));
    const auto open = line.find_first_of("{[");
    if (open == std::string_view::npos || open + 1 == line.size() || !isLetter(line[open + 1])) return {};
    const auto close = line.find(line[open] == '{' ? '}' : ']', open);
    if (close == std::string_view::npos) return {};
    const std::string_view found = line.substr(open, close + 1 - open);
    return found.find('#') == std::string_view::npos ? found
                                                     : std::string_view();  // LinuxCNC's "[ABS[#<_h>]]" is a sum
}

// "{global.bed}" or "{move.axes[2].max}": RepRapFirmware's object model. Placeholders of slicers have no dots.
bool isExpression(std::string_view placeholder) {
    const auto end =
        placeholder.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ[]0123456789", 1);
    return placeholder.front() == '{' && end != std::string_view::npos && placeholder[end] == '.';
}

std::string templateIn(std::string_view bytes) {
    for (std::size_t number = 1; !bytes.empty(); ++number)
        if (const auto found = placeholderIn(takePiece(bytes, '\n')); !found.empty())
            return isExpression(found)
                       ? fmt::format(
                             "a macro: line {} has {}, which RepRapFirmware computes; give the "
                             ".gcode file that a slicer saves",
                             number, found.substr(0, 60))
                       : fmt::format(
                             "a template: line {} has {}, which a slicer replaces by a value; slice a model with it "
                             "and give the .gcode file that the slicer saves",
                             number, found.substr(0, 60));
    return {};
}

}  // namespace

std::string describeTrade(std::string_view bytes) {
    bytes = bytes.substr(0, kTradeReach);
    if (std::string text = templateIn(bytes); !text.empty()) return text;
    Signs signs;
    Lexer lexer(bytes);
    Line line;
    while (lexer.next(line)) {
        if (!line.comment.empty()) addWords(line.comment, signs);
        for (std::size_t i = 0; i < line.count; ++i) addCommand(line.commands[i], signs);
    }
    // MakerBot's M6 waits for a tool to be hot.
    const bool plunges = signs.mills > 0 || (signs.prints == 0 && signs.plunges + signs.tool_changes > 0);
    if (signs.says_laser || (signs.burns > 0 && signs.starts > 0 && !plunges)) return "a program for a laser";
    if (signs.says_pen || signs.pens > 0) return "a program for a pen plotter";
    if (plunges) return "a program for a mill or router (CNC)";
    if (signs.starts > 0) return "a program for a laser, a mill or another cutting machine";
    return {};
}

}  // namespace stratum::gcode
