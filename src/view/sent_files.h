// Files that pages send, in a folder of this process that goes with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace stratum::view {

/// For one thread at a time.
class SentFiles {
public:
    static constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;  ///< of one file
    static constexpr std::uint64_t kMostOfAll = 4 * kMostBytes;          ///< bytes of all that are kept
    static constexpr std::size_t kMostFiles = 100;

    SentFiles() = default;
    /// Removes them.
    ~SentFiles();
    SentFiles(const SentFiles&) = delete;
    SentFiles& operator=(const SentFiles&) = delete;

    /// A place for another file, in a folder of its own that only this user may read; nothing is there yet. `name` may
    /// be anything: what leads to other folders, or can't be shown, is left out. Throws InputError if there is no room.
    std::filesystem::path place(std::string_view name);
    /// One that is of no use.
    static void remove(const std::filesystem::path& path);

private:
    std::filesystem::path folder_;  // made for the first one
    std::size_t count_ = 0;
};

}  // namespace stratum::view
