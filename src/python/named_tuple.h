// Results with several parts: named tuples of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <utility>

namespace stratum::python {

/// Adds the type to the module.
inline void defineNamedTuple(pybind11::module_& module, const char* name, const char* fields, const char* doc) {
    const auto type = pybind11::module_::import("collections").attr("namedtuple")(name, fields);
    type.attr("__doc__") = doc;
    module.attr(name) = type;
}

/// One of that type.
template <typename... Parts>
pybind11::object namedTuple(const char* name, Parts&&... parts) {
    return pybind11::module_::import("stratum._stratum").attr(name)(std::forward<Parts>(parts)...);
}

}  // namespace stratum::python
