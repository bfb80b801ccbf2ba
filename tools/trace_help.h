// What vdbtrace -h shows.
#pragma once

#include "manual.h"

namespace stratum::tools {

extern const char* const kTraceExamples;

Brief traceBrief();

}  // namespace stratum::tools
