// Objects that Python makes without a value, as X.__new__(X) and copying do: pybind11 would read their value from
// memory that nobody has written.
#pragma once

#include <pybind11/pybind11.h>

namespace stratum::python {

/// The method of a class whose objects may be empty at first, as pickle makes them: it gives one its first value.
constexpr const char* kBeginEmpty = "_begin_empty";

/// Refuses them for all classes of the module but those. To be called behind the last class.
void refuseBareObjects(pybind11::module_& module);

}  // namespace stratum::python
