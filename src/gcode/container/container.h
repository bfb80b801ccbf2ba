// From the bytes of a file, in whatever container, to the plain text of one G-code program.
//
//   ascii   plain text
//   gzip    RFC 1952, any number of members
//   bgcode  Prusa's binary G-code (prusa3d/libbgcode, doc/specifications.md)
//   3mf     .gcode.3mf of BambuStudio and OrcaSlicer: a zip with Metadata/plate_N.gcode
//   ufp     Ultimaker Format Package: a zip with /3D/model.gcode
//   gx      FlashPrint: a binary header and thumbnails before the text
//
// Told apart by content, never by name. Containers are not opened inside containers.
#pragma once

#include "gcode/container/byte_buffer.h"
#include "gcode/slicer/package_facts.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::gcode {

/// What a container may unpack to. Real G-code packs to a third or a tenth; `most_ratio` is what only a bomb exceeds,
/// and does not hold below `any_ratio_bytes`, so that tiny files of one repeated line pass.
struct ContainerLimits {
    std::size_t most_bytes = std::size_t{4} << 30;
    std::size_t most_ratio = 200;
    std::size_t any_ratio_bytes = std::size_t{64} << 20;

    /// The most bytes that a file of `packed` bytes may become.
    std::size_t bytesFrom(std::size_t packed) const;
};

/// One program as text, and what its container says about it.
struct Program {
    std::string format;     ///< one of the names above
    std::string_view text;  ///< into `unpacked`, or into the bytes given to openContainer
    ByteBuffer unpacked;    ///< empty where the text needed no unpacking
    /// Settings stored beside the text, in the file's order. The text has them too, as "; key = value" at its end.
    std::vector<std::pair<std::string, std::string>> metadata;
    std::optional<double> filament_mm;  ///< all filament that the container says the program uses
    PackageFacts facts;                 ///< what else it says
    std::string cut_short;              ///< why the program seems to end too early; empty if it doesn't
};

/// Called now and then with the fraction done, 0..1. May be empty.
using Progress = std::function<void(double)>;

/// Opens what `bytes` are; they must outlive the result. `plate` chooses one of several programs (3mf only). `name`
/// stands in messages. Throws InputError for a damaged, truncated or oversized container, naming block or byte, and
/// UsageError for a plate that isn't there. Text that is no container is handed back as it is: "ascii".
Program openContainer(std::string_view bytes, std::string_view name, std::optional<int> plate = {},
                      const ContainerLimits& limits = {}, const Progress& progress = {});

}  // namespace stratum::gcode
