#include "gcode/lexer.h"

#include "gcode/number.h"

#include <algorithm>
#include <cstring>

namespace stratum::gcode {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isLetter(char c) {
    const char lower = static_cast<char>(c | 0x20);
    return lower >= 'a' && lower <= 'z';
}
char upper(char c) { return static_cast<char>(c & ~0x20); }

// Commands whose argument is text or a file name, so that "M117 G1 X5" moves nothing (Marlin's parser.cpp, GCODE_TEXT).
bool takesText(char letter, std::int32_t code) {
    if (letter != 'M') return false;
    switch (code) {
        case 16:
        case 23:
        case 28:
        case 30:
        case 32:
        case 33:
        case 36:
        case 37:
        case 38:
        case 117:
        case 118:
        case 550:
        case 551:
        case 552:
        case 587:
        case 588:
        case 589:
        case 928:
            return true;
        default:
            return false;
    }
}

const char* skipBlanks(const char* p, const char* end) {
    while (p != end && isBlank(*p)) ++p;
    return p;
}

const char* find(const char* p, const char* end, char c) {
    const void* const hit =
        p == end ? nullptr : std::memchr(p, static_cast<unsigned char>(c), static_cast<std::size_t>(end - p));
    return hit ? static_cast<const char*>(hit) : end;
}

// Reads digits as an integer; more than any firmware has saturate.
std::int32_t takeInteger(const char*& p, const char* end) {
    std::int32_t value = 0;
    for (; p != end && isDigit(*p); ++p) value = std::min(value * 10 + (*p - '0'), 9'999'999);
    return value;
}

std::string_view view(const char* from, const char* to) { return {from, static_cast<std::size_t>(to - from)}; }

// One line at work: where a command ends is known only when the next begins.
class LineLexer {
public:
    LineLexer(std::string_view text, Line& line) : p_(text.data()), end_(text.data() + text.size()), line_(line) {}

    void run() {
        p_ = skipBlanks(p_, end_);
        if (p_ == end_ || *p_ == '%') return;  // '%' alone marks the ends of a CNC program
        skipLineNumber();
        while (p_ != end_) {
            const char c = *p_;
            if (isBlank(c)) {
                ++p_;
            } else if (isLetter(c)) {
                word();
            } else if (c == ';') {
                closeText(p_);
                line_.comment = view(p_ + 1, end_);
                return;
            } else if (c == '(') {
                const char* const close = find(p_, end_, ')');
                if (line_.comment.empty()) line_.comment = view(p_ + 1, close);
                p_ = close == end_ ? end_ : close + 1;
            } else if (c == '"') {  // the text value of the parameter before it
                const char* const close = find(p_ + 1, end_, '"');
                p_ = close == end_ ? end_ : close + 1;
            } else if (c == '*') {
                ++p_;
                p_ = skipBlanks(p_, end_);
                takeInteger(p_, end_);
            } else {
                line_.unreadable = true;
                ++p_;
            }
        }
        closeText(end_);
    }

private:
    void skipLineNumber() {
        if (upper(*p_) != 'N') return;
        const char* q = skipBlanks(p_ + 1, end_);
        if (q == end_ || !isDigit(*q)) return;
        takeInteger(q, end_);
        p_ = q;
    }

    void word() {
        const char* next = p_ + 1;
        const char letter = upper(*p_);
        if (line_.count == 0 && next != end_ && (isLetter(*next) || *next == '_')) {
            // Tx and Tc are Prusa's "ask for a tool", not macros.
            if (letter == 'T' && (next + 1 == end_ || isBlank(next[1]) || next[1] == ';')) return tool(next);
            return extended();
        }
        next = skipBlanks(next, end_);
        const bool number = next != end_ && isDigit(*next);
        if ((letter == 'G' || letter == 'M') && number) return numbered(letter, next);
        if (letter == 'T' && line_.count == 0) return tool(next);
        if (!command_) open();
        double value = 0;
        if (parseNumber(next, end_, value)) {
            command_->set(letter, value);
            p_ = next;
        } else {
            command_->set(letter);
            ++p_;
        }
    }

    Command& open() {
        closeText(p_);
        if (line_.count == Line::kMaxCommands) {  // only noise has so many; the last slot takes the rest
            line_.unreadable = true;
            --line_.count;
        }
        command_ = &line_.commands[line_.count++];
        command_->clear();
        return *command_;
    }

    void numbered(char letter, const char* digits) {
        Command& command = open();
        command.kind = Command::Kind::numbered;
        command.letter = letter;
        command.code = takeInteger(digits, end_);
        if (digits != end_ && *digits == '.') {
            ++digits;
            command.subcode = takeInteger(digits, end_);
        }
        p_ = text_ = digits;
        if (!takesText(letter, command.code)) return;
        p_ = find(p_, end_, ';');
        closeText(p_);
    }

    void tool(const char* digits) {
        Command& command = open();
        command.kind = Command::Kind::numbered;
        command.letter = 'T';
        command.code = -1;
        if (digits != end_ && isDigit(*digits)) {
            command.code = takeInteger(digits, end_);
        } else {  // T-1, T?, Tx: no tool by number
            while (digits != end_ && !isBlank(*digits) && *digits != ';') ++digits;
        }
        p_ = text_ = digits;
    }

    void extended() {
        Command& command = open();
        command.kind = Command::Kind::extended;
        const char* const start = p_;
        while (p_ != end_ && (isLetter(*p_) || isDigit(*p_) || *p_ == '_' || *p_ == '.')) ++p_;
        command.name = view(start, p_);
        text_ = p_;
        p_ = find(p_, end_, ';');
        closeText(p_);
    }

    void closeText(const char* to) {
        if (command_ && text_) command_->text = view(text_, to);
        text_ = nullptr;
    }

    const char* p_;
    const char* end_;
    const char* text_ = nullptr;
    Command* command_ = nullptr;  // the one being filled
    Line& line_;
};

}  // namespace

void Command::clear() {
    kind = Kind::words;
    letter = 0;
    code = 0;
    subcode = 0;
    name = {};
    text = {};
    present_ = 0;
    valued_ = 0;
}

void Command::set(char parameter, double number) {
    const std::uint32_t i = index(parameter);
    present_ |= 1U << i;
    valued_ |= 1U << i;
    values_[i] = number;
}

Lexer::Lexer(std::string_view bytes) : begin_(bytes.data()), p_(begin_), end_(begin_ + bytes.size()) {
    if (bytes.starts_with("\xEF\xBB\xBF")) p_ += 3;
    newline_ = find(p_, end_, '\n');
}

std::string_view Lexer::takeLine() {
    if (newline_ < p_) newline_ = find(p_, end_, '\n');
    const char* const start = p_;
    const char* const stop = find(start, newline_, '\r');
    p_ = stop;
    if (p_ != end_ && *p_ == '\r') ++p_;
    if (p_ != end_ && p_ == newline_) ++p_;
    return view(start, stop);
}

bool Lexer::next(Line& line) {
    if (p_ == end_) return false;
    line.number = ++number_;
    line.count = 0;
    line.comment = {};
    line.unreadable = false;
    LineLexer(takeLine(), line).run();
    return true;
}

}  // namespace stratum::gcode
