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

#include "base/input_file.h"
#include "gcode/container/byte_buffer.h"
#include "gcode/container/package_facts.h"

#include <cstddef>
#include <cstdint>
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

// The bytes of an input file, a pipe or standard input.

/// Whether a path can be read only once: "-", standard input, or a pipe such as the shell's <(zcat FILE).
bool isStream(const std::string& path);

/// A file, or all of a stream. Movable, not copyable.
class InputBytes {
public:
    /// Whether to wait for the bytes of a stream, or refuse it: where the input is read anew when it has changed.
    enum class Streams : std::uint8_t { read, refuse };
    /// Throws InputError if there is nothing to read, or more than `most` bytes come from a stream.
    explicit InputBytes(const std::string& path, Streams streams = Streams::read,
                        std::size_t most = std::size_t{4} << 30);

    std::string_view bytes() const { return file_ ? file_->bytes() : buffer_.view(); }
    /// For messages: the path, or "standard input".
    const std::string& name() const { return name_; }

private:
    std::string name_;
    std::optional<InputFile> file_;
    ByteBuffer buffer_;
};

/// Reads `descriptor` to its end. Throws InputError.
ByteBuffer readAll(int descriptor, std::string_view name, std::size_t most);

// Rejects files that are not G-code, by content, never by name.

/// Without the zero bytes at the end that cards and printers leave there.
std::string_view withoutZeroTail(std::string_view bytes);

/// Throws InputError, with the kind of the bytes and the remedy, if they are empty, a container (inside another one),
/// a model, a picture, a file of another machine, or binary. Cheap: reads the beginning only. `bytes` has no zero tail,
/// unless it has nothing else.
void refuseOtherFormats(std::string_view bytes, std::string_view name);

}  // namespace stratum::gcode
