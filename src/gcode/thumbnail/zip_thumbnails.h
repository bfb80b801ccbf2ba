// Thumbnails in zip containers.
//
//   3mf  Metadata/plate_N.png and plate_N_small.png. Source: BambuStudio and OrcaSlicer, bbs_3mf.cpp
//   ufp  /Metadata/thumbnail.png. Source: Cura's UFPWriter, libCharon
//
// Where the program's text has thumbnails too (OrcaSlicer), they are replaced as well, and so is the MD5 of the text
// beside it (Metadata/plate_N.gcode.md5).
#pragma once

#include "gcode/thumbnail/patched_bytes.h"
#include "gcode/thumbnail/thumbnail.h"

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// The pictures of one container. Movable; its bytes and the name, for messages, must outlive it.
class ZipThumbnails {
public:
    /// Finds them, and unpacks the program once. Throws InputError if the container has no picture or is damaged.
    /// @param plate  of a .gcode.3mf with several
    ZipThumbnails(std::string_view bytes, std::string_view name, std::optional<int> plate);
    ~ZipThumbnails();
    ZipThumbnails(ZipThumbnails&&) noexcept;
    ZipThumbnails& operator=(ZipThumbnails&&) noexcept;

    /// What the container has to hold: the largest PNG that is asked for; for plate_N_small.png the smallest of
    /// several, or one in its own size; and all that is asked for if the text has thumbnails. Throws UsageError if no
    /// PNG is asked for.
    std::vector<ThumbnailSize> pictures(std::span<const ThumbnailSize> asked) const;

    /// The container with those pictures. All other entries keep their packed bytes and their order.
    PatchedBytes patched(std::span<const ThumbnailSize> asked, std::span<const Thumbnail> pictures) const;

private:
    struct Entries;
    std::string_view bytes_, name_;
    std::unique_ptr<const Entries> entries_;
};

}  // namespace stratum::gcode
