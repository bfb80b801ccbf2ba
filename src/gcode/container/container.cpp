#include "gcode/container/container.h"

#include "base/error.h"
#include "gcode/container/bgcode.h"
#include "gcode/container/gx.h"
#include "gcode/container/gzip.h"
#include "gcode/container/zip_container.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::gcode {

std::size_t ContainerLimits::bytesFrom(std::size_t packed) const {
    const std::size_t by_ratio =
        packed > most_bytes / std::max<std::size_t>(most_ratio, 1) ? most_bytes : packed * most_ratio;
    return std::min(most_bytes, std::max(any_ratio_bytes, by_ratio));
}

Program openContainer(std::string_view bytes, std::string_view name, std::optional<int> plate,
                      const ContainerLimits& limits, const Progress& progress) {
    Program program;
    if (isGzip(bytes)) {
        program = openGzip(bytes, name, limits, progress);
    } else if (isBgcode(bytes)) {
        program = openBgcode(bytes, name, limits, progress);
    } else if (isZip(bytes)) {
        program = openZip(bytes, name, plate, limits, progress);
    } else if (isGx(bytes)) {
        program = openGx(bytes, name);
    } else {
        program.format = "ascii";
        program.text = bytes;
    }
    if (plate && program.format != "3mf")
        throw UsageError(fmt::format("{}: --plate {}: only a .gcode.3mf has plates", name, *plate));
    return program;
}

}  // namespace stratum::gcode
