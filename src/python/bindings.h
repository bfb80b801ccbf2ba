// What the module adds.
#pragma once

#include <pybind11/pybind11.h>

namespace stratum::python {

/// stratum.report() and stratum.compare(): numbers of a print.
void bindMeasures(pybind11::module_& module);
/// stratum.Picture and render().
void bindPicture(pybind11::module_& module);

}  // namespace stratum::python
