// The errors of the libraries as exceptions of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <string_view>

namespace stratum::python {

/// A text of the libraries, which name options as command lines do, with the names of Python's parameters:
/// "--voxel-size" is "voxel_size". Command lines of the tools stay as they are.
std::string inPython(std::string_view text);

/// Adds InputError, UsageError (a ValueError) and OutputError (an OSError), with the texts that the tools print, but
/// inPython().
void bindErrors(pybind11::module_& module);

}  // namespace stratum::python
