// Zip files that contain programs: their entries, by libzip. openZip() opens the program in them.
#pragma once

#include "gcode/container/byte_buffer.h"
#include "gcode/container/container.h"

#include <zip.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::gcode {

struct ZipDiscard {
    void operator()(zip_t* archive) const { zip_discard(archive); }
    void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using ZipArchive = std::unique_ptr<zip_t, ZipDiscard>;

/// Opens `bytes`, which must outlive it, for reading. Throws InputError.
ZipArchive openZipArchive(std::string_view bytes, std::string_view name);

struct ZipPlate {
    int number = 0;
    zip_uint64_t index = 0;
};

/// The relevant entries of a zip file.
struct ZipContents {
    std::vector<ZipPlate> plates;  ///< ascending
    std::optional<zip_uint64_t> ufp_model;
    std::optional<zip_uint64_t> slice_info;  ///< of a 3mf
    std::optional<zip_uint64_t> relations;   ///< of a ufp's model
    std::vector<std::pair<std::string, zip_uint64_t>> materials;
    bool model = false;             ///< an unsliced 3MF model
    std::string_view foreign = {};  ///< what else it is, and what to do; empty if nothing tells
    zip_int64_t entries = 0;
};

/// Throws InputError for more entries than any print has.
ZipContents listZip(zip_t* archive, std::string_view name);

/// The plate of that number, or the only one. Throws UsageError.
const ZipPlate& chooseZipPlate(const std::vector<ZipPlate>& plates, std::string_view name, std::optional<int> wanted);

/// Appends an entry to `text` and checks its size and CRC32. Throws InputError, also for more than `most` bytes.
void unpackZipEntry(zip_t* archive, zip_uint64_t index, std::string_view name, std::size_t most, ByteBuffer& text,
                    const Progress& progress);

// Zip files that contain a program: .gcode.3mf (BambuStudio, OrcaSlicer) and .ufp (Ultimaker). Unzipped by libzip.
// Sources: BambuStudio's bbs_3mf.cpp (Metadata/plate_N.gcode), Ultimaker's libCharon (/3D/model.gcode).

bool isZip(std::string_view bytes);

/// Unpacks the chosen plate of a 3mf, the only one by default, or the model of an ufp, and checks its CRC32. Throws
/// InputError for damage and for zip files with no or several programs, UsageError for a plate that doesn't exist.
Program openZip(std::string_view bytes, std::string_view name, std::optional<int> plate, const ContainerLimits& limits,
                const Progress& progress = {});

}  // namespace stratum::gcode
