// stratum.report() and stratum.compare(): numbers of a print.
#pragma once

#include <pybind11/pybind11.h>

namespace stratum::python {

void bindMeasures(pybind11::module_& module);

}  // namespace stratum::python
