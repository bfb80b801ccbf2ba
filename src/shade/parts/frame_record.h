// Which pictures of a film are finished, so that a repeated shard goes on where it was stopped.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace stratum::shade {

/// A text file beside the pictures: of each, a hash of its scene, the SHA-256 of its bytes, its name. A finished
/// picture has the bytes of one without --shard, so it can't say itself what it is of.
class FrameRecord {
public:
    /// Reads the file if it is there. Lines that are damaged count as missing: those pictures are made again.
    explicit FrameRecord(std::filesystem::path path);
    /// Whether the picture is recorded, of that scene, and still has its bytes.
    bool has(const std::filesystem::path& picture, const std::string& scene) const;
    /// Records a picture that is written, and replaces the file. Throws OutputError.
    void add(const std::filesystem::path& picture, const std::string& scene);

private:
    struct Entry {
        std::string scene, bytes;  // hashes
    };
    std::filesystem::path path_;
    std::map<std::string, Entry> entries_;  // by the name without its folder
};

}  // namespace stratum::shade
