// A toolpath as bytes and back: what pickle keeps.
#pragma once

#include "python/toolpath_object.h"

#include <string>
#include <string_view>

namespace stratum::python {

/// Every field, with a version and a checksum. Equal toolpaths have equal bytes. Needs no GIL.
std::string stateOf(const ToolpathObject& object);

/// The same toolpath. Throws InputError, with the remedy, for bytes of another version, or that are damaged. Needs no
/// GIL.
ToolpathObject toolpathOf(std::string_view state);

}  // namespace stratum::python
