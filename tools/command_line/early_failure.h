// What fails before main() begins.
#pragma once

namespace stratum::tools {

/// Libraries that the tools are linked with start threads before main() (log4cplus, of OpenVDB). Where that fails, as
/// with a small `ulimit -v`, the process says so and ends with 1 instead of aborting. main() calls this first: from
/// then on a std::terminate() is a defect and aborts as usual.
void mainHasBegun();

}  // namespace stratum::tools
