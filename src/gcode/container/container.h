// Finds the container of a file's bytes and unpacks the plain text of one G-code program.
//
//   ascii   plain text
//   gzip    RFC 1952, any number of members
//   bgcode  Prusa's binary G-code (prusa3d/libbgcode, doc/specifications.md)
//   3mf     .gcode.3mf of BambuStudio and OrcaSlicer: a zip with Metadata/plate_N.gcode
//   ufp     Ultimaker Format Package: a zip with /3D/model.gcode
//   gx      FlashPrint: a binary header and thumbnails before the text
//
// Formats are recognized by content, never by name. Nested containers are not opened.
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

/// Limits of the unpacked size. Real G-code packs to a third or a tenth; only a zip bomb exceeds `most_ratio`. The
/// ratio is not checked below `any_ratio_bytes`, so that tiny files of one repeated line pass.
struct ContainerLimits {
    std::size_t most_bytes = std::size_t{4} << 30;
    std::size_t most_ratio = 200;
    std::size_t any_ratio_bytes = std::size_t{64} << 20;

    /// The limit for a file of `packed` bytes.
    std::size_t bytesFrom(std::size_t packed) const;
};

/// One program as text, and its container's metadata.
struct Program {
    std::string format;     ///< one of the names above
    std::string_view text;  ///< into `unpacked`, or into the bytes given to openContainer
    ByteBuffer unpacked;    ///< empty where the text needed no unpacking
    /// Settings stored beside the text, in the file's order. The text has them too, as "; key = value" at its end.
    std::vector<std::pair<std::string, std::string>> metadata;
    std::optional<double> filament_mm;  ///< all filament of the program, as the container states it
    PackageFacts facts;                 ///< other statements of the container
    std::string cut_short;              ///< why the program seems to end too early; empty if it doesn't
};

/// Called from time to time with the fraction done, 0..1. May be empty.
using Progress = std::function<void(double)>;

/// Opens a container; `bytes` must outlive the result. `plate` chooses one of several programs (3mf only). `name` is
/// used in messages. Throws InputError for a damaged, truncated or oversized container, naming block or byte, and
/// UsageError for a plate that doesn't exist. Bytes without a container are returned unchanged, as "ascii".
Program openContainer(std::string_view bytes, std::string_view name, std::optional<int> plate = {},
                      const ContainerLimits& limits = {}, const Progress& progress = {});

}  // namespace stratum::gcode
