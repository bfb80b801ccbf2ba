// Errors that are the user's to mend, and the exit status each one maps to.
//
// Libraries throw these and never print or exit; the tools catch them once, in main. Anything else that escapes
// (std::bad_alloc, a logic_error) is a defect or the machine's limit and ends with status 1.
#pragma once

#include <stdexcept>
#include <string>

namespace stratum {

/// Input that can't be used: missing, empty, of another kind, out of range. Exit status 3.
/// The text says the place (file, line or block), what was expected and what to do.
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

}  // namespace stratum
