// Tells when files were written anew, without looking at them again and again.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace stratum::view {

/// Watches (inotify) each file, its folder and, of a symbolic link, all that it leads over: programs that write a file
/// beside the old one and rename it are noticed, and a write under another of its names. A file counts as changed when
/// it has been closed after writing, or has got its name.
class FileWatch {
public:
    explicit FileWatch(const std::vector<std::string>& paths = {});
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    /// Further files; those that are watched stay so. Files of one folder share a watch. Of a folder that is not there,
    /// the nearest one above it is watched. From any thread.
    void add(const std::vector<std::string>& paths);
    /// Readable when something has happened; -1 if the system has no inotify.
    int descriptor() const { return descriptor_; }
    /// The files that have changed since the last call. Does not wait. From any thread.
    std::set<std::string> changed();

private:
    using Identity = std::tuple<std::uint64_t, std::uint64_t, std::int64_t, std::int64_t, std::int64_t>;
    static Identity identityOf(const std::string& path);
    void arm(const std::string& path);
    void watch(const std::string& place, std::uint32_t events, const std::string& name, const std::string& path);

    int descriptor_ = -1;
    std::mutex mutex_;                                                      // of the next ones
    std::map<std::string, Identity> files_;                                 // by path, as it was last told of
    std::map<int, std::set<std::pair<std::string, std::string>>> watches_;  // names in a folder, and paths they lead to
};

}  // namespace stratum::view
