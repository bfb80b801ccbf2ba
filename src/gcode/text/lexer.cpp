#include "gcode/text/lexer.h"

#include "base/text.h"
#include "gcode/text/number.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace stratum::gcode {
namespace {

bool isWhite(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool isDigit(char c) { return c >= '0' && c <= '9'; }
char upper(char c) { return static_cast<char>(c & ~0x20); }

// Commands whose argument is text, a file name or other commands, so that "M117 G1 X5" moves nothing (Marlin's
// parser.cpp; M98: docs.duet3d.com; M810-M819 keep their commands for later; G9111: Anycubic's macro, "bedTemp=60";
// M1002 and M1006: Bambu's flags by name and its tunes, "C37 D10 M60").
bool takesText(char letter, std::int32_t code) {
    if (letter != 'M') return code == 9111;
    if (code >= 810 && code <= 819) return true;
    constexpr std::array kCodes{0,   1,   16,  23,  28,  30,  32,  33,  36,  37,   38,  98,
                                117, 118, 550, 551, 552, 587, 588, 589, 928, 1002, 1006};
    return std::find(kCodes.begin(), kCodes.end(), code) != kCodes.end();
}

// Letters that a line may begin with to go on with the motion in force: axes, arcs and the feed rate.
bool goesOn(char letter) { return std::string_view("XYZEFIJKRABCUVW").find(letter) != std::string_view::npos; }

const char* skipBlanks(const char* p, const char* end) {
    while (p != end && isWhite(*p)) ++p;
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

// The state of one line: the end of a command is known only when the next one begins.
class LineLexer {
public:
    LineLexer(std::string_view text, Line& line) : p_(text.data()), end_(text.data() + text.size()), line_(line) {}

    void run() {
        p_ = skipBlanks(p_, end_);
        if (p_ == end_ || *p_ == '%') return;  // '%' alone marks the ends of a CNC program
        skipLineNumber();
        p_ = skipBlanks(p_, end_);
        if (p_ != end_ && *p_ == '=')
            return;  // "===== record data =====": a comment whose ';' is missing (Bambu's H2C)
        if (p_ != end_ && *p_ == '@' && !isPause()) return;
        if (p_ != end_ && *p_ == '{') {  // "{if layer_z == 0.8}M600": a condition that no slicer has replaced
            line_.unreadable = true;
            return;
        }
        if (p_ != end_ && *p_ == '/') {
            line_.deleted = p_ + 1 == end_ || p_[1] != '/';  // two of them are a comment
            return;
        }
        while (p_ != end_) {
            const char c = *p_;
            if (isWhite(c)) {
                ++p_;
            } else if (isLetter(c)) {
                word();
            } else if (c == '_' && line_.count == 0) {
                extended();
            } else if (c == ';') {
                closeText(p_);
                line_.comment = view(p_ + 1, end_);
                return;
            } else if (c == '(') {
                const char* const close = closing();
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
                line_.decimal_comma |= isDecimalComma();
                line_.unreadable = true;
                ++p_;
            }
        }
        closeText(end_);
    }

private:
    // The parenthesis that closes the one at p_, which may hold others; the first one if they are not balanced.
    const char* closing() {
        const char* const first = find(p_, end_, ')');
        if (unbalanced_ || find(p_ + 1, first, '(') == first) return first;
        int depth = 0;
        for (const char* p = p_; p != end_; ++p) {
            if (*p == '(') ++depth;
            if (*p == ')' && --depth == 0) return p;
        }
        unbalanced_ = true;  // once a line: time stays linear
        return first;
    }

    // Of what begins with '@' for the host, which keeps it from the printer (OctoPrint), "@pause" stops the print.
    bool isPause() const {
        constexpr std::string_view kPause = "@PAUSE";
        return end_ - p_ >= std::ssize(kPause) &&
               std::equal(kPause.begin(), kPause.end(), p_, [](char a, char b) { return a == upper(b); });
    }

    // "X10,5": a comma between the digits of a word of a command.
    bool isDecimalComma() const {
        return *p_ == ',' && command_ && p_ + 1 != end_ && isDigit(p_[1]) && isDigit(p_[-1]);
    }

    // WEEDO's printers get their pictures in rows of hexadecimal digits: "W220 140d0c...", between W221 and W222.
    bool isPicture() const {
        return line_.count == 0 && end_ - p_ >= 4 && p_[1] == '2' && p_[2] == '2' && isDigit(p_[3]) &&
               (end_ - p_ == 4 || isWhite(p_[4]) || p_[4] == ';');
    }

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
        if (named_ && letter == 'A') {  // the rest of the line is a name
            const char* name = skipBlanks(p_ + 1, end_);
            if (name != end_ && *name == '"') name = find(name + 1, end_, '"');
            p_ = find(name, end_, ';');
            return closeText(p_);
        }
        if (line_.count == 0 && next != end_ && (isLetter(*next) || *next == '_')) {
            // Tx and Tc are Prusa's "ask for a tool", not macros.
            if (letter == 'T' && (next + 1 == end_ || isWhite(next[1]) || next[1] == ';')) return tool(next);
            return extended();
        }
        next = skipBlanks(next, end_);
        const bool number = next != end_ && isDigit(*next);
        if ((letter == 'G' || letter == 'M') && number) return numbered(letter, next);
        if (letter == 'T' && line_.count == 0) return tool(next);
        if (letter == 'W' && isPicture()) return picture();
        if (!command_) {
            open();
            if (!goesOn(letter)) foreign();
        }
        double value = 0;
        if (parseNumber(next, end_, value)) {
            command_->set(letter, value);
            p_ = next;
            if (p_ != end_ && (*p_ == '[' || *p_ == '{')) {  // "Z0.3[first_layer_height]": its letters are no words
                line_.unreadable = true;
                p_ = behindBraces(p_);
            }
        } else if (next != end_ && (*next == '{' || *next == '[')) {
            // "[first_layer_height]": a slicer's name that nobody has replaced.
            command_->setExpression(letter);
            p_ = behindBraces(next);
        } else {
            command_->set(letter);
            ++p_;
        }
    }

    void foreign() {
        command_->kind = Command::Kind::foreign;
        const char* const word_end = std::find_if(p_, end_, [](char c) { return isWhite(c) || c == ';' || c == '('; });
        command_->name = view(p_, word_end);
    }

    void picture() {
        open();
        foreign();
        p_ = find(p_, end_, ';');
    }

    // Behind the brace that closes the one at `p`, or the end.
    const char* behindBraces(const char* p) const {
        int depth = 0;
        for (; p != end_; ++p) {
            if (*p == '{' || *p == '[') ++depth;
            if ((*p == '}' || *p == ']') && --depth == 0) return p + 1;
        }
        return p;
    }

    Command& open() {
        closeText(p_);
        if (line_.count == Line::kMaxCommands) {  // only damaged lines; the last slot is reused
            line_.unreadable = true;
            --line_.count;
        }
        command_ = &line_.commands[line_.count++];
        command_->clear();
        named_ = false;
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
        named_ = letter == 'M' && command.code == 486;
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
            while (digits != end_ && !isWhite(*digits) && *digits != ';') ++digits;
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
    bool named_ = false;          // it is M486, whose A begins a name
    bool unbalanced_ = false;     // of parentheses
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
    expression_ = 0;
}

void Command::set(char parameter, double number) {
    const std::uint32_t i = index(parameter);
    present_ |= 1U << i;
    valued_ |= 1U << i;
    expression_ &= ~(1U << i);
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
    line.decimal_comma = false;
    line.deleted = false;
    LineLexer(takeLine(), line).run();
    return true;
}

}  // namespace stratum::gcode
