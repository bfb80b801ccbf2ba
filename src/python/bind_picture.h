// stratum.Picture and render().
#pragma once

#include <pybind11/pybind11.h>

namespace stratum::python {

void bindPicture(pybind11::module_& module);

}  // namespace stratum::python
