// Replaces the thumbnails of G-code in any container.
#pragma once

#include "gcode/thumbnail/container_thumbnails.h"
#include "gcode/thumbnail/patched_bytes.h"
#include "gcode/thumbnail/thumbnail.h"

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// One file whose thumbnails are to be replaced: first pictures() says which are needed, then patched() takes them.
/// The bytes and the name, for messages, must outlive it.
class ThumbnailFile {
public:
    /// Throws InputError for a zip container without pictures.
    /// @param plate  of a .gcode.3mf with several
    ThumbnailFile(std::string_view bytes, std::string_view name, std::vector<ThumbnailSize> asked,
                  std::optional<int> plate = {});

    /// The pictures that the file has to hold: what is asked for, or what its container has places for. Throws
    /// UsageError for what it can't hold, InputError.
    std::vector<ThumbnailSize> pictures() const;

    /// Of what is asked for, what is not among pictures(): the container has no place for it. Throws as pictures().
    std::vector<ThumbnailSize> leftOut() const;

    /// The file with those pictures, in their order, in place of its own. Text keeps its other lines, a container its
    /// other parts. It stays what it is: gzip is packed again. Throws InputError.
    PatchedBytes patched(std::span<const Thumbnail> pictures) const;

private:
    std::string_view bytes_, name_;
    std::vector<ThumbnailSize> asked_;
    std::optional<ZipThumbnails> zip_;  // if that is its container
};

/// Writes the pieces one after the other, see AtomicFile. Throws OutputError.
void writePatched(const PatchedBytes& bytes, const std::filesystem::path& path);

}  // namespace stratum::gcode
