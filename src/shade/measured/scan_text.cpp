#include "shade/measured/scan_text.h"

#include "base/error.h"
#include "base/text.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <cmath>

namespace stratum::shade {
bool ScanText::next(std::string_view& line) {
    while (!rest_.empty()) {
        const std::size_t end = rest_.find('\n');
        line = trim(rest_.substr(0, end), " \t\r");
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
        ++line_;
        if (line.starts_with('#')) {
            if (comments_.size() < 16) comments_.emplace_back(trim(line.substr(1), " \t\r").substr(0, 200));
        } else if (!line.empty()) {
            return true;
        }
    }
    return false;
}

std::string_view ScanText::expect(std::string_view what) {
    std::string_view line;
    if (!next(line)) fail(fmt::format("the file ends where {} is expected; it is cut short", what));
    return line;
}

std::vector<double> ScanText::numbers(std::size_t count, std::string_view what) {
    std::vector<double> all;
    all.reserve(count);
    while (all.size() < count) {
        const std::vector<double> some = parse(expect(what), what);
        all.insert(all.end(), some.begin(), some.end());
    }
    if (all.size() > count)
        fail(fmt::format("has {} numbers too many; expected {} {}", all.size() - count, count, what));
    return all;
}

std::vector<double> ScanText::parse(std::string_view text, std::string_view what) const {
    constexpr std::string_view kSeparators = " \t,;";
    std::vector<double> values;
    for (;;) {
        const std::size_t first = text.find_first_not_of(kSeparators);
        if (first == std::string_view::npos) return values;
        text.remove_prefix(first);
        const std::string_view word = text.substr(0, text.find_first_of(kSeparators));
        double value = 0.0;
        const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
        const auto [end, error] = fast_float::from_chars(begin, word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
            fail(fmt::format("'{}' is no number; expected {}", word.substr(0, 40), what));
        values.push_back(value);
        text.remove_prefix(word.size());
    }
}

void ScanText::fail(std::string_view message) const {
    throw InputError(fmt::format("{}: line {}: {}", name_, line_, message));
}

Keyword splitKeyword(std::string_view line) {
    const std::size_t end = line.find_first_of(" \t:=");
    if (end == std::string_view::npos) return {line, {}};
    const std::size_t value = line.find_first_not_of(" \t:=", end);
    return {line.substr(0, end), value == std::string_view::npos ? std::string_view{} : line.substr(value)};
}

std::size_t countOf(const ScanText& text, std::string_view value, std::string_view what, std::size_t low,
                    std::size_t high) {
    const std::vector<double> numbers = text.parse(value, what);
    if (numbers.size() != 1 || !(numbers[0] >= static_cast<double>(low) && numbers[0] <= static_cast<double>(high)) ||
        numbers[0] != std::floor(numbers[0]))
        text.fail(fmt::format("'{}': expected {}, a whole number from {} to {}", value.substr(0, 40), what, low, high));
    return static_cast<std::size_t>(numbers[0]);
}

}  // namespace stratum::shade
