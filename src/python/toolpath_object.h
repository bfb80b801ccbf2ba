// stratum.Toolpath: a print's beads and all that its file states.
#pragma once

#include "deposit/read_print.h"
#include "gcode/toolpath/toolpath.h"

#include <pybind11/pybind11.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace stratum::python {

/// Never changes once it is made, so that any number of threads read it without the GIL.
struct ToolpathObject {
    std::shared_ptr<const gcode::Toolpath> toolpath;
    std::optional<motion::PrintTimes> times;                       ///< if it was read so
    std::shared_ptr<const std::vector<motion::Travel>> travels{};  ///< if it was read so; else null
    std::string source;         ///< name of its file without folders; empty if it has none
    std::string source_sha256;  ///< of that file; empty for an edited toolpath
};

/// Adds stratum.Toolpath, read() and make_toolpath().
void bindToolpath(pybind11::module_& module);

}  // namespace stratum::python
