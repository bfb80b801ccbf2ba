// Output that appears whole or not at all: written beside its destination, then renamed over it.
#pragma once

#include <filesystem>

namespace stratum {

/// One output file in the making. Write to `temporary()`, then `commit()`. Without a commit (an exception, a signal
/// that the tool handles) the temporary is removed and what stood at the destination stays.
class AtomicFile {
public:
    /// Throws OutputError if the directory is missing or can't be written to: before the work, not after it.
    explicit AtomicFile(std::filesystem::path destination);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& destination() const { return destination_; }

    /// Flushes the temporary to the disk and renames it. Throws OutputError.
    void commit();

    /// Makes SIGINT, SIGTERM, SIGHUP, SIGPIPE and those of exceeded limits remove the temporaries under way before the
    /// process ends by that signal; a shell then sees 128 plus its number, 130 for SIGINT.
    static void removeOnSignals();

private:
    std::filesystem::path destination_;
    std::filesystem::path temporary_;
    int slot_ = -1;
};

}  // namespace stratum
