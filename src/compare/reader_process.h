// Runs a reader that can crash on damaged files in a process of its own.
#pragma once

#include <functional>
#include <string>

namespace stratum::compare {

/// What `read` returns, called in a copy of this process: an assertion or a wild access there ends the copy alone.
/// @param name  of the file, for messages
/// Throws InputError: the text of what `read` threw, or that it crashed, or took more than two minutes, or more than 1
/// GB and 300 times the file's length; std::bad_alloc if the process can't be made.
std::string readInProcess(const std::string& name, const std::function<std::string()>& read);

}  // namespace stratum::compare
