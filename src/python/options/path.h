// Paths of Python: str and os.PathLike, with bytes of the file system that are no text.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace stratum::python {

inline bool isPath(const pybind11::handle& value) {
    return pybind11::isinstance<pybind11::str>(value) || pybind11::hasattr(value, "__fspath__");
}

/// Throws TypeError for what is no path, ValueError for one with a null byte.
inline std::string pathOf(const pybind11::handle& value) {
    auto path = pybind11::module_::import("os").attr("fsencode")(value).cast<std::string>();
    if (path.find('\0') != std::string::npos) throw pybind11::value_error("embedded null byte in a path");
    return path;
}

}  // namespace stratum::python
