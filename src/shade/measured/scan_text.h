// Reads lines and numbers of a scatterometer's text file, with positions for messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::shade {

/// Reads a text line by line. LF and CR LF; lines that start with '#' are comments, which are collected.
class ScanText {
public:
    /// @param name  of the file, for messages
    ScanText(std::string_view text, std::string_view name) : rest_(text), name_(name) {}

    /// The next line that is neither empty nor a comment, without white space around; false at the end.
    bool next(std::string_view& line);
    /// The same; throws InputError if there is none, naming what was expected.
    std::string_view expect(std::string_view what);
    /// Exactly `count` numbers from the next lines. Throws InputError.
    std::vector<double> numbers(std::size_t count, std::string_view what);
    /// All numbers of a text, separated by white space, commas or semicolons. Throws InputError.
    std::vector<double> parse(std::string_view text, std::string_view what) const;
    /// Throws InputError: file, line, message.
    [[noreturn]] void fail(std::string_view message) const;

    /// Comments read so far, without the '#'.
    const std::vector<std::string>& comments() const { return comments_; }
    std::size_t line() const { return line_; }

private:
    std::string_view rest_;
    std::string name_;
    std::size_t line_ = 0;
    std::vector<std::string> comments_;
};

/// First word of a line and the rest, trimmed. Words end at white space, ':' or '='.
struct Keyword {
    std::string_view key, value;
};
Keyword splitKeyword(std::string_view line);

/// A count from a file, in [low, high]. Throws InputError.
std::size_t countOf(const ScanText& text, std::string_view value, std::string_view what, std::size_t low,
                    std::size_t high);

// From the spectral channels of a file to the three of a Color.

/// Indices of the wavelengths (nm) for red, green and blue: the nearest to 612, 549 and 465 nm, the dominant
/// wavelengths of the primaries. A single wavelength is used for all three: gray.
struct ChannelChoice {
    std::size_t red, green, blue;
};
ChannelChoice chooseChannels(const std::vector<double>& wavelengths);

}  // namespace stratum::shade
