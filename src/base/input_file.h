// An input file, read into memory: what happens to it later does not matter.
//
// It is not mapped: a mapped file that shrinks ends the process by SIGBUS, and one that is rewritten in place changes
// below its reader, behind all checks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string_view>

namespace stratum {

/// The bytes of a regular file, read in blocks when they are asked for. All of them are of one version of the file.
/// Movable, not copyable; safe to read from several threads.
class InputFile {
public:
    /// Opens `path`. Throws InputError if it is missing, a directory, a stream (it does not wait for its writer),
    /// unreadable or empty.
    explicit InputFile(const std::filesystem::path& path);
    ~InputFile();
    InputFile(InputFile&& other) noexcept;
    InputFile& operator=(InputFile&& other) noexcept;
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;

    /// All of it. Throws InputError if the file has changed since it was opened, or can't be read.
    std::string_view bytes() const;
    /// The first bytes: `count`, or all.
    std::string_view first(std::size_t count) const;
    /// All of it, but only what load() was called for is read; the rest may be zero.
    std::string_view unread() const;
    /// Reads these bytes, which must be in the file, unless they were read before. Throws as bytes() does.
    void load(std::size_t offset, std::size_t count) const;
    std::size_t size() const;
    const std::filesystem::path& path() const;

private:
    struct Contents;
    std::unique_ptr<Contents> contents_;
};

}  // namespace stratum
