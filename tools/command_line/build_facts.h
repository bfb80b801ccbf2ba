// What --version tells beside the number: enough to reproduce a build, or to report a fault.
#pragma once

#include <string>

namespace stratum::tools {

/// "NAME VERSION", then the compiler, the kind of build, the instruction sets that this machine will use and the
/// libraries, a line each.
std::string buildFacts(const std::string& tool);

}  // namespace stratum::tools
