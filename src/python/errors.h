// The errors of the libraries as exceptions of Python.
#pragma once

#include <pybind11/pybind11.h>

namespace stratum::python {

/// Adds InputError, UsageError (a ValueError) and OutputError (an OSError), with the texts that the tools print.
void bindErrors(pybind11::module_& module);

}  // namespace stratum::python
