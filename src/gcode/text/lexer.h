// Bytes -> lines -> commands with their parameters: the grammar only, not the meaning of commands.
//
// Handled here: N words and *checksums, ';' and '(...)' comments, lower case, missing spaces, tabs, LF, CR, CRLF and
// any mixture of them, a byte order mark, bytes that are not text, parentheses in parentheses (Skeinforge), rows of
// pictures (WEEDO's W220), several commands in a line (RepRapFirmware, CNC),
// commands whose argument is free text (M117 ...) or ends with a name (M486 A...), Klipper's extended commands
// (SET_THING A=1), RepRapFirmware's expressions in braces, and lines that begin with '/'.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace stratum::gcode {

/// One command and its parameters. Letters are upper case.
struct Command {
    enum class Kind : std::uint8_t {
        words,     ///< parameters only: they belong to the modal motion command
        foreign,   ///< a line that begins with a letter of no known command ("Q603 ...")
        numbered,  ///< G1, M82, T0, G92.1
        extended,  ///< a macro or extended command, in `name`
    };
    Kind kind = Kind::words;
    char letter = 0;           ///< 'G', 'M' or 'T' of a numbered command
    std::int32_t code = 0;     ///< its number; -1 for a T without a number (T?, Tx)
    std::int32_t subcode = 0;  ///< 1 of G92.1
    std::string_view name;     ///< of an extended or foreign command, as written
    std::string_view text;     ///< the text behind the code or name, up to the comment: for free-text arguments

    /// Some parameter has no number.
    bool lacksNumbers() const { return (present_ & ~valued_) != 0; }
    bool has(char parameter) const { return ((present_ >> index(parameter)) & 1U) != 0; }
    /// Without a number, but with an expression of RepRapFirmware ("F{60*var.speed}"), which is not evaluated.
    bool isExpression(char parameter) const { return ((expression_ >> index(parameter)) & 1U) != 0; }
    /// Some parameter of those in maskOf().
    bool hasAny(std::uint32_t mask) const { return (present_ & mask) != 0; }
    static std::uint32_t maskOf(std::string_view letters) {
        std::uint32_t mask = 0;
        for (const char letter : letters) mask |= 1U << index(letter);
        return mask;
    }
    bool hasValue(char parameter) const { return ((valued_ >> index(parameter)) & 1U) != 0; }
    /// The parameter's number. Only meaningful if hasValue().
    double value(char parameter) const { return values_[index(parameter)]; }

    void clear();
    /// Without a number; if a letter is repeated, the last one counts.
    void set(char parameter) {
        present_ |= 1U << index(parameter);
        valued_ &= ~(1U << index(parameter));
        expression_ &= ~(1U << index(parameter));
    }
    void setExpression(char parameter) {
        set(parameter);
        expression_ |= 1U << index(parameter);
    }
    void set(char parameter, double number);

private:
    static std::uint32_t index(char letter) { return static_cast<std::uint32_t>(letter - 'A') & 31U; }
    std::uint32_t present_ = 0;
    std::uint32_t valued_ = 0;
    std::uint32_t expression_ = 0;
    std::array<double, 32> values_;  // only those marked in valued_ are ever read
};

/// One line of the source. Views point into the bytes given to the Lexer.
struct Line {
    static constexpr std::size_t kMaxCommands = 16;
    std::uint32_t number = 0;  ///< 1-based
    std::size_t count = 0;     ///< commands used
    std::array<Command, kMaxCommands> commands;
    std::string_view
        comment;  ///< without its ';' or parentheses, untrimmed; if there are several, that with ';' or the first
    bool unreadable = false;     ///< parts of it are neither words nor comments
    bool decimal_comma = false;  ///< among them a comma between digits
    bool deleted = false;        ///< begins with one '/' (block delete, NIST RS274/NGC 3.3.1): its commands are skipped
};

/// Splits bytes into lines. Allocates nothing; the bytes must outlive it.
class Lexer {
public:
    explicit Lexer(std::string_view bytes);

    /// Reads the next line, also an empty one. Returns false at the end.
    bool next(Line& line);

    /// Bytes consumed so far.
    std::size_t offset() const { return static_cast<std::size_t>(p_ - begin_); }

private:
    std::string_view takeLine();

    const char* begin_;
    const char* p_;
    const char* end_;
    const char* newline_;  // the next '\n' at or after p_, cached so that files with bare CR aren't searched repeatedly
    std::uint32_t number_ = 0;
};

}  // namespace stratum::gcode
