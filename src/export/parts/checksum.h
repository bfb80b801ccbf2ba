// How damage to the head of a part is found.
#pragma once

#include <string>
#include <string_view>

namespace stratum::exporter {

/// For VdbArchive::header(): makes the UUID of a part tell whether what stands between the header and the leaves is as
/// it was written.
std::string identityOfPart(std::string_view before_leaves);

}  // namespace stratum::exporter
