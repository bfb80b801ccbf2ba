#include "python/errors.h"

#include "base/error.h"

namespace stratum::python {

namespace py = pybind11;

void bindErrors(py::module_& module) {
    py::register_exception<InputError>(module, "InputError", PyExc_RuntimeError).attr("__doc__") =
        "Input that can't be used: missing, empty, of another kind, out of range. The text says where and what to do.";
    py::register_exception<UsageError>(module, "UsageError", PyExc_ValueError).attr("__doc__") =
        "An option, an array, or a combination of them that makes no sense for this input.";
    py::register_exception<OutputError>(module, "OutputError", PyExc_OSError).attr("__doc__") =
        "An output that could not be written. An old file of that name is untouched.";
}

}  // namespace stratum::python
