// Atomic output: a file is written without a name, or beside its destination, and then renamed over it.
#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>

namespace stratum {

/// Whether a destination means standard output: "-", or "-.ENDING" where the ending selects the format. A file of such
/// a name is given as ./-.
bool isStandardOutput(const std::filesystem::path& destination);

/// Which files that are there already may be replaced. Libraries replace any; tools and the Python module guard files
/// that this program did not write: those with its mark (isOwnFile()) and empty ones alone are replaced without asking.
class Replacement {
public:
    /// Whether to guard them from now on. Off at first, and again by --force.
    static void guard(bool on);
    /// This file may be replaced for as long as the object lives.
    explicit Replacement(const std::filesystem::path& destination, bool allowed = true);
    ~Replacement();
    Replacement(const Replacement&) = delete;
    Replacement& operator=(const Replacement&) = delete;

    /// Throws UsageError if the file is there and may not be replaced.
    static void check(const std::filesystem::path& destination);

private:
    std::string destination_;  // empty: nothing is allowed
};

/// One output file being written. Write to `temporary()`, then `commit()`. Without a commit (an exception, a signal
/// that the tool handles) no new file is left and an old file at the destination stays.
///
/// If the file system has files without a name (Linux: O_TMPFILE), the file gets its name when it is complete, and even
/// a killed process or a power failure leaves nothing behind. Otherwise, e.g. on NFS, it is in the same folder as
/// ".NAME.PROCESS.part"; a file left by a killed process is removed by the next one with the same destination. A lock
/// (flock) distinguishes it from the file of a running process.
///
/// A symbolic link stays, and the file that it names is replaced. A file is only replaced if
/// Replacement allows it.
///
/// Streams can't be renamed over: standard output, and a destination that is not a regular file (a pipe, a device).
/// They get the bytes with the commit, from a file in the folder for temporary files.
class AtomicFile {
public:
    enum class Making {
        unnamed,  ///< if the file system supports it
        named,    ///< always a named temporary file
    };

    /// Throws OutputError if the directory is missing or can't be written to: before the work, not after it; UsageError
    /// if the file is there and may not be replaced.
    explicit AtomicFile(std::filesystem::path destination, Making making = Making::unnamed);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Throws as the constructor does, and leaves nothing open: a pipe's reader would take that for the end.
    static void probe(const std::filesystem::path& destination);

    /// Path to write to; valid in this process only.
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& destination() const { return destination_; }

    /// Flushes the file to the disk and renames it to its destination. Throws OutputError.
    void commit();
    /// For writers whose errors name the path they are given: calls writer(temporary()), replaces that path by the
    /// destination in the OutputError that it throws, and commits.
    void write(const std::function<void(const std::filesystem::path&)>& writer);

    /// Handles SIGINT, SIGTERM, SIGHUP, SIGPIPE and those of exceeded limits: removes unfinished files before the
    /// process ends by that signal; a shell then gets the status 128 plus its number, 130 for SIGINT.
    static void removeOnSignals();

private:
    void openStream();
    void pour();
    bool openUnnamed();
    void openNamed();
    void close();

    std::filesystem::path destination_;
    std::filesystem::path target_;     // what it names, if it is a link
    std::filesystem::path part_;       // its name beside the destination
    std::filesystem::path temporary_;  // part_, or a name that is valid in this process only
    int fd_ = -1;                      // holds the lock
    int stream_ = -1;                  // the destination, if it is a stream
    int slot_ = -1;                    // of part_, while there is such a file
};

/// An atomic file that is written from its beginning to its end, a megabyte at a time.
class FileWriter {
public:
    /// Throws as AtomicFile does.
    explicit FileWriter(const std::filesystem::path& destination);

    void text(std::string_view text) {
        buffer_.append(text);
        if (buffer_.size() >= kChunk) flush();
    }
    /// As the machine holds it.
    template <typename T>
    void raw(const T& value) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        text({bytes, sizeof(T)});
    }
    /// What was written is in the file. Throws OutputError.
    void close();
    /// Closes it, and gives it its name. Throws OutputError.
    void commit();

private:
    static constexpr std::size_t kChunk = 1 << 20;
    void flush();

    AtomicFile file_;
    std::ofstream out_;
    std::string buffer_;
};

/// All of a file at once, as AtomicFile does. Throws OutputError, UsageError.
void writeFile(const std::filesystem::path& destination, std::string_view bytes);

}  // namespace stratum
