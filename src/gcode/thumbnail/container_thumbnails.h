// Thumbnails in containers: binary G-code, FlashPrint's .gx, and zip files.
//
//   bgcode  blocks of type 5. Source: github.com/prusa3d/libbgcode, doc/specifications.md.
#pragma once

#include "gcode/thumbnail/patched_bytes.h"
#include "gcode/thumbnail/thumbnail.h"

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace stratum::gcode {

/// The file with these thumbnails and no others: where its own stood, else behind the printer's metadata. All other
/// blocks keep their bytes. Throws InputError for damage, which it names by block.
PatchedBytes withBgcodeThumbnails(std::string_view bytes, std::span<const Thumbnail> thumbnails, std::string_view name);

// The pictures of FlashPrint's .gx: a BMP of 80 x 60 pixels with 24 bits each, and in newer files a PNG of any size
// behind it. See gcode/container/gx.h for the layout and its sources.

/// The pictures that the file has to hold: its BMP, and its PNG if it has one, in the size that is asked for or else in
/// its own. Throws UsageError if others are asked for, InputError if the file has no picture.
std::vector<ThumbnailSize> gxPictures(std::string_view bytes, std::span<const ThumbnailSize> asked,
                                      std::string_view name);

/// The file with those pictures; the offsets in its head follow them.
PatchedBytes withGxThumbnails(std::string_view bytes, std::span<const Thumbnail> pictures);

// Zip files.
//
//   3mf  Metadata/plate_N.png and plate_N_small.png. Source: BambuStudio and OrcaSlicer, bbs_3mf.cpp
//   ufp  /Metadata/thumbnail.png. Source: Cura's UFPWriter, libCharon
//
// Where the program's text has thumbnails too (OrcaSlicer), they are replaced as well, and so is the MD5 of the text
// beside it (Metadata/plate_N.gcode.md5).

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
