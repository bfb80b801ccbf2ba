// Errors that the user can correct, and the exit status of each.
//
// Libraries throw these and never print or exit; the tools catch them once, in main. Other exceptions (std::bad_alloc,
// a logic_error) are defects or a lack of memory; they end the tool with status 1.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace stratum {

/// Input that can't be used: missing, empty, of another kind, out of range. Exit status 3.
/// The text has the location (file, line or block), the expected input and the remedy.
class InputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An option or a combination of options that makes no sense for this input. Exit status 2.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// An output that could not be written. Exit status 1; the old file, if any, is untouched.
class OutputError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The error of a write that failed.
/// @param name  of the file
/// @param why   what the system says, if it says anything
inline OutputError writeError(const std::string& name, std::string_view why = {}) {
    std::string text = name + ": could not be written";
    if (!why.empty()) text.append(" (").append(why).append(")");
    return OutputError(text + "; is the disk full?");
}

}  // namespace stratum
