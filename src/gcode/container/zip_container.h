// Zip files that contain a program: .gcode.3mf (BambuStudio, OrcaSlicer) and .ufp (Ultimaker). Unzipped by libzip.
// Sources: BambuStudio's bbs_3mf.cpp (Metadata/plate_N.gcode), Ultimaker's libCharon (/3D/model.gcode).
#pragma once

#include "gcode/container/container.h"

namespace stratum::gcode {

bool isZip(std::string_view bytes);

/// Unpacks the chosen plate of a 3mf, the only one by default, or the model of an ufp, and checks its CRC32. Throws
/// InputError for damage and for zip files with no or several programs, UsageError for a plate that doesn't exist.
Program openZip(std::string_view bytes, std::string_view name, std::optional<int> plate, const ContainerLimits& limits,
                const Progress& progress = {});

}  // namespace stratum::gcode
