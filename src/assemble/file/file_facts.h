// Metadata of level sets, and the identity of files.
#pragma once

#include "trace/intersector.h"

#include <openvdb/openvdb.h>

#include <optional>
#include <string>
#include <vector>

namespace stratum::assemble {

/// Whether a file holds an OpenVDB grid, by its first bytes; standard input ("-") doesn't. Throws InputError for one
/// that can't be read or is empty.
bool isVdbFile(const std::string& path);

/// "mm", "cm" or "m", if the file states its world unit, else "world units"; other programs' files don't state it.
std::string unitOf(const openvdb::FloatGrid& grid);

/// The axis that points up, "z" or "y", as the file states; "z" if it doesn't.
std::string upOf(const openvdb::FloatGrid& grid);

/// The part's box without what is printed beside it, in the file's world space; empty if the file doesn't state it.
std::optional<trace::Box> partOf(const openvdb::FloatGrid& grid);

/// Points around the part in the file's world space, closer than its box; none if the file doesn't state them.
std::vector<glm::dvec3> outlineOf(const openvdb::FloatGrid& grid);

/// A warning if the narrow band is thinner than OpenVDB's tools expect; else empty.
std::string thinBandWarning(const std::string& path, const openvdb::FloatGrid& grid);

/// Identifies a file without reading all of it: its size, the time of its last change, and a hash of how it
/// begins and ends (a .vdb begins with an identifier of its own). Empty if there is no such file.
std::string identityOf(const std::string& path);

}  // namespace stratum::assemble
