// Whether a file was written by this program, so that it may be replaced without asking.
#pragma once

#include <filesystem>

namespace stratum {

/// The mark that every file of a kind with room for one carries, with the version behind it: a comment, a header, a
/// metadata entry.
inline constexpr const char* kProgramMark = "Stratum " STRATUM_VERSION;

/// Whether the file has such a mark, of any version and tool ("Stratum 1.0", "gcode2vdb 1.0", ..), in its first or last
/// mebibyte, in a text where these programs write it ("by Stratum 1.0"), or is a table of beads as --dump-toolpath
/// writes it. False if it can't be read.
bool isOwnFile(const std::filesystem::path& path);

}  // namespace stratum
