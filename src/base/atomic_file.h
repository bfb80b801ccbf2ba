// Output that appears whole or not at all: written without a name, or beside its destination, then renamed over it.
#pragma once

#include <filesystem>
#include <functional>

namespace stratum {

/// Whether a destination means standard output: "-", or "-.ENDING" where the ending says what to write. A file of such
/// a name is reached as ./-.
bool isStandardOutput(const std::filesystem::path& destination);

/// One output file in the making. Write to `temporary()`, then `commit()`. Without a commit (an exception, a signal
/// that the tool handles) nothing is left and what stood at the destination stays.
///
/// Where the file system has files without a name (Linux: O_TMPFILE), the file gets its name when it is whole, and not
/// even a run that is killed or a machine that loses power leaves anything behind. Elsewhere, on NFS for one, it lies
/// in the same folder as ".NAME.PROCESS.part"; what a killed run leaves there, the next one with the same destination
/// removes. A lock (flock) tells it from the file of a run that is still at work.
///
/// Streams have nothing to be renamed over: standard output, and what stands at the destination and is no regular file
/// (a pipe, a device). They get the bytes with the commit, from a file in the folder for temporary files.
class AtomicFile {
public:
    enum class Making {
        unnamed,  ///< if the file system can
        named,    ///< as where it can't
    };

    /// Throws OutputError if the directory is missing or can't be written to: before the work, not after it.
    explicit AtomicFile(std::filesystem::path destination, Making making = Making::unnamed);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// To be opened by this process alone.
    const std::filesystem::path& temporary() const { return temporary_; }
    const std::filesystem::path& destination() const { return destination_; }

    /// Flushes the file to the disk and puts it in its place. Throws OutputError.
    void commit();
    /// For writers that know no other name than the one they are given: calls writer(temporary()), tells the
    /// OutputError that it throws of the destination instead, and commits.
    void write(const std::function<void(const std::filesystem::path&)>& writer);

    /// Makes SIGINT, SIGTERM, SIGHUP, SIGPIPE and those of exceeded limits remove what is under way before the
    /// process ends by that signal; a shell then sees 128 plus its number, 130 for SIGINT.
    static void removeOnSignals();

private:
    void openStream();
    void pour();
    bool openUnnamed();
    void openNamed();
    void close();

    std::filesystem::path destination_;
    std::filesystem::path part_;       // its name beside the destination
    std::filesystem::path temporary_;  // part_, or a name that only this process sees
    int fd_ = -1;                      // holds the lock
    int stream_ = -1;                  // where the bytes go in the end, if that is a stream
    int slot_ = -1;                    // of part_, while there is such a file
};

}  // namespace stratum
