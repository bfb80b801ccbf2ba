// How many threads the module's calls use.
#pragma once

#include <pybind11/pybind11.h>

namespace stratum::python {

/// Adds set_threads() and threads().
void bindThreads(pybind11::module_& module);

}  // namespace stratum::python
