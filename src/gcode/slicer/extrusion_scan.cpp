#include "gcode/slicer/extrusion_scan.h"

#include "gcode/text/lexer.h"

#include <algorithm>
#include <cstring>

namespace stratum::gcode {
namespace {

constexpr std::size_t kEnoughMoves = 400;
constexpr std::size_t kFewestMoves = 12;
// Absolute E decreases only in wipes; of relative values about half are smaller than the one before.
constexpr std::size_t kFallsInMoves = 4;

class Scanner {
public:
    // False once all is known.
    bool command(const Command& command) {
        if (command.kind == Command::Kind::numbered) {
            if (command.letter == 'M') return miscellaneous(command.code);
            motion_ = command.letter == 'G' && command.code <= 3;
            if (command.letter == 'G' && command.code == 92 && command.has('E')) last_ = 0;
            if (!motion_) return true;
        } else if (command.kind == Command::Kind::extended || !motion_) {
            return true;
        }
        const bool plan = command.has('X') || command.has('Y');
        if (command.hasValue('E')) return extrusion(plan, command.value('E'));
        if (plan && (command.hasValue('A') || command.hasValue('B'))) ab_ = true;
        return true;
    }

    ExtrusionScan result() const {
        using Drive = ExtrusionScan::Drive;
        if (e_) return {.falls_back = moves_ >= kFewestMoves && falls_ * kFallsInMoves > moves_};
        return {.drive = ab_ ? Drive::axes_ab : switch_ ? Drive::switched : Drive::e_word};
    }

private:
    bool miscellaneous(int code) {
        if (code == 82 || code == 83) mode_ = true;
        if (code == 101) switch_ = true;
        return !(mode_ && e_);
    }

    bool extrusion(bool plan, double value) {
        e_ = true;
        if (mode_) return false;
        if (!plan) {
            last_ = value;
            return true;
        }
        if (value < last_) ++falls_;
        last_ = value;
        return ++moves_ < kEnoughMoves;
    }

    bool motion_ = false;
    bool mode_ = false;
    bool switch_ = false;
    bool ab_ = false;
    bool e_ = false;
    double last_ = 0;
    std::size_t moves_ = 0;
    std::size_t falls_ = 0;
};

// The start of the line that `at` is in.
std::size_t lineStart(std::string_view bytes, std::size_t at) {
    const auto end = bytes.substr(0, at).find_last_of("\r\n");
    return end == std::string_view::npos ? 0 : end + 1;
}

// Whether the line at `start` has that command, not only its letters in a comment.
bool hasCommand(std::string_view bytes, std::size_t start, char letter, std::int32_t code) {
    Lexer lexer(bytes.substr(start));
    Line line;
    if (!lexer.next(line)) return false;
    for (std::size_t i = 0; i < line.count; ++i) {
        const Command& command = line.commands[i];
        if (command.letter == letter && command.code == code && command.subcode == 0) return true;
    }
    return false;
}

// The first command of that text at or behind `from`; npos if there is none.
std::size_t findCommand(std::string_view bytes, std::string_view text, std::size_t from) {
    const std::int32_t code = (text[1] - '0') * 10 + (text[2] - '0');
    while (from < bytes.size()) {
        const void* const hit = ::memmem(bytes.data() + from, bytes.size() - from, text.data(), text.size());
        if (hit == nullptr) break;
        const auto at = static_cast<std::size_t>(static_cast<const char*>(hit) - bytes.data());
        if (hasCommand(bytes, lineStart(bytes, at), text[0], code)) return at;
        from = at + text.size();
    }
    return std::string_view::npos;
}

// Counts moves with E, and those where E decreases, after the positions where the mode is unclear.
struct Falls {
    std::size_t moves = 0;
    std::size_t falls = 0;

    // From `bytes` until something sets E's mode anew, or there is enough.
    void count(std::string_view bytes) {
        Lexer lexer(bytes);
        Line line;
        double last = 0;
        while (moves < kEnoughMoves && lexer.next(line)) {
            for (std::size_t i = 0; i < line.count; ++i) {
                const Command& command = line.commands[i];
                const bool set = command.letter == 'M' && (command.code == 82 || command.code == 83);
                if (set ||
                    (command.letter == 'G' && command.subcode == 0 && (command.code == 90 || command.code == 91)))
                    return;
                if (command.letter == 'G' && command.code == 92 && command.has('E')) last = 0;
                const bool motion =
                    command.kind == Command::Kind::words || (command.letter == 'G' && command.code <= 3);
                if (!motion || !command.hasValue('E')) continue;
                if (command.has('X') || command.has('Y')) {
                    ++moves;
                    if (command.value('E') < last) ++falls;
                }
                last = command.value('E');
            }
        }
    }
};

}  // namespace

bool fallsBackAfterG90(std::string_view bytes) {
    constexpr auto kNone = std::string_view::npos;
    Falls found;
    std::size_t m83 = findCommand(bytes, "M83", 0);
    std::size_t m82 = m83 == kNone ? kNone : findCommand(bytes, "M82", m83);
    while (m83 != kNone && found.moves < kEnoughMoves) {
        const std::size_t g90 = findCommand(bytes, "G90", m83);
        if (g90 == kNone) break;
        if (m82 < g90) {  // M82 came between: the next M83 counts
            m83 = findCommand(bytes, "M83", m82);
            m82 = m83 == kNone ? kNone : findCommand(bytes, "M82", m83);
            continue;
        }
        const auto line_end = std::min(bytes.find('\n', g90), bytes.size());
        found.count(bytes.substr(line_end));
        m83 = line_end;  // the slicer still assumes this mode
    }
    return found.moves >= kFewestMoves && found.falls * kFallsInMoves > found.moves;
}

ExtrusionScan scanExtrusion(std::string_view bytes) {
    Scanner scanner;
    Lexer lexer(bytes);
    Line line;
    bool more = true;
    while (more && lexer.next(line))
        for (std::size_t i = 0; more && i < line.count; ++i) more = scanner.command(line.commands[i]);
    return scanner.result();
}

}  // namespace stratum::gcode
