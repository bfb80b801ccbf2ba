// The files of one run, so that none is destroyed by a slip: what is written may be no input, nor be written twice.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace stratum::tools {

/// Files are the same if the file system says so: by another path, a symbolic or a hard link. Streams (- and devices)
/// are never the same, but that standard output has one writer.
class RunFiles {
public:
    /// Something that is read: an input, a map, a material. "" and "-" are none. What doesn't exist is left to its
    /// reader to complain of.
    void reads(const std::string& path);

    /// @param option  that named it, for messages; "" if the name was made up
    /// Throws UsageError if the file is read or written by this run already, or may not be replaced (Replacement). ""
    /// is no file.
    void writes(const std::string& path, std::string_view option);
    /// The same of a file whose whole name was given, beside what the run makes. Throws OutputError if it can't be
    /// written: before the work, not after it.
    void writesBeside(const std::string& path, std::string_view option);

private:
    void use(const std::string& path, std::string_view option);

    struct Use {
        std::string path, option;
        bool read = false;
    };
    std::map<std::string, Use> uses_;  // by identity
};

}  // namespace stratum::tools
