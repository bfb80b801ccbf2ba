#include "command_source.h"

#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace stratum::tools {
namespace {

// Those that are called otherwise: SECONDS stand behind --time, and what may be repeated is named in the singular.
constexpr Names<std::string_view, 4> kOwnNames = {
    {{"seconds", "time"}, {"lights", "light"}, {"objects", "object"}, {"tools", "tool"}}};

// The number that the whole text is, also with a plus in front; or nothing.
template <typename Number>
std::optional<Number> parsed(const std::string& text) {
    return stratum::parsed<Number>(std::string_view(text).substr(text.starts_with('+') ? 1 : 0));
}

std::optional<double> parsedNumber(const std::string& text) {
    const std::optional<double> value = parsed<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

}  // namespace

std::string CommandSource::called(std::string_view name) const {
    std::string option = "--" + std::string(valueOf(kOwnNames, name).value_or(name));
    std::replace(option.begin(), option.end(), '_', '-');
    return option;
}

bool CommandSource::given(std::string_view name) const {
    const CLI::Option* option = app_->get_option_no_throw(called(name));
    return option != nullptr && option->count() > 0;
}

std::vector<std::string> CommandSource::texts(std::string_view name) {
    const CLI::Option* option = app_->get_option_no_throw(called(name));
    return option != nullptr ? option->results() : std::vector<std::string>();
}

std::optional<std::string> CommandSource::text(std::string_view name) {
    std::vector<std::string> given = texts(name);
    if (given.empty()) return std::nullopt;
    return std::move(given.back());
}

std::optional<double> CommandSource::number(std::string_view name) {
    const std::optional<std::string> given = text(name);
    if (!given) return std::nullopt;
    const std::optional<double> value = parsedNumber(*given);
    if (!value) fail(name, "a number");
    return value;
}

std::optional<std::int64_t> CommandSource::integer(std::string_view name, std::int64_t least, std::int64_t most) {
    const std::optional<std::string> given = text(name);
    if (!given) return std::nullopt;
    const std::optional<std::int64_t> value = parsed<std::int64_t>(*given);
    if (!value || *value < least || *value > most) fail(name, fmt::format("a whole number from {} to {}", least, most));
    return value;
}

std::optional<bool> CommandSource::flag(std::string_view name) {
    const std::vector<std::string> given = texts(name);
    if (given.empty()) return std::nullopt;
    if (given.front() != given.back())
        throw UsageError(fmt::format("{0} and --no-{1}: give one of them", called(name), called(name).substr(2)));
    return given.front() == "true";
}

std::vector<double> CommandSource::list(std::string_view name, char separator) {
    std::vector<double> values;
    for (const std::string& text : texts(name))
        for (const std::string& word : CLI::detail::split(text, separator)) {
            const std::optional<double> value = parsedNumber(word);
            if (!value) fail(name, "numbers, with no spaces between them");
            values.push_back(*value);
        }
    return values;
}

void CommandSource::fail(std::string_view name, std::string_view expected) const {
    const CLI::Option* option = app_->get_option(called(name));
    // What a list looks like; of other options the type says less than the text.
    const std::string type = option->get_type_name();
    const std::string form = type.find_first_of(",x") != std::string::npos ? type + ": " : "";
    refuse(name, form + std::string(expected));
}

void CommandSource::refuse(std::string_view name, std::string_view expected) const {
    const CLI::Option* option = app_->get_option(called(name));
    const bool flag = option->get_expected_max() == 0;
    throw UsageError(fmt::format("{}{}: expected {}", called(name),
                                 flag ? "" : fmt::format(" {}", fmt::join(option->results(), " ")), expected));
}

CLI::Option* Declarations::operator()(const char* name, const char* type, const std::string& help) const {
    return app_.add_option(name, help)->type_name(type)->group(group_);
}

CLI::Option* Declarations::several(const char* name, const char* type, const std::string& help) const {
    return (*this)(name, type, help)->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(false);
}

CLI::Option* Declarations::flag(const char* names, const std::string& help) const {
    return app_.add_flag(names, help)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)->group(group_);
}

}  // namespace stratum::tools
