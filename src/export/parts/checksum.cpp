#include "export/parts/checksum.h"

#include "base/checksum.h"

#include <fmt/format.h>

namespace stratum::exporter {

std::string identityOfPart(std::string_view before_leaves) {
    return fmt::format("part of a print, {:08x} {}", checksumOf(before_leaves), before_leaves.size());
}

}  // namespace stratum::exporter
