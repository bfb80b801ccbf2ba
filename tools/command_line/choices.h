// The values that an option takes, for checks, for guesses at mistyped ones, and for the shell to complete.
#pragma once

#include "base/names.h"

#include <CLI/CLI.hpp>

#include <string>
#include <utility>
#include <vector>

namespace stratum::tools {

/// How a shell completes the value of an option.
enum class Completion {
    word,       ///< one of the names
    list,       ///< names, separated by commas
    selection,  ///< names with + or - before each, separated by commas
    preset      ///< one of the names, or a file
};

/// The names of a table, for completion.
template <typename Value, std::size_t N>
std::vector<std::string> wordsOf(const Names<Value, N>& names) {
    const auto list = listOf(names);
    return {list.begin(), list.end()};
}

/// A check: the value is one of the names. The message guesses which was meant.
CLI::Validator oneOf(std::vector<std::string> names);

/// A check: the value is one of the names of a table.
template <typename Value, std::size_t N>
CLI::Validator oneOf(const Names<Value, N>& names) {
    return oneOf(wordsOf(names));
}

/// The same for enumerations, to be given to CLI::Option::transform(): the name becomes its number.
CLI::Validator enumeration(std::vector<std::pair<std::string, int>> values);

/// Notes the names for completion alone; the option's own reader checks them.
CLI::Option* completes(CLI::Option* option, Completion how, const std::vector<std::string>& names);

/// What completes() noted, or the names of oneOf(); no names if there are none.
struct Choices {
    Completion how = Completion::word;
    std::vector<std::string> names;
};
Choices choicesOf(const CLI::Option& option);

/// What CLI11 appends to a type name for its checks, ":{a,b}".
std::string checksOf(const CLI::Option& option);

}  // namespace stratum::tools
