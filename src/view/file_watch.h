// Tells when files were written anew, without looking at them again and again.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace stratum::view {

/// Watches the folders of the files (inotify): also programs that write a file beside the old one and rename it are
/// noticed. A file counts as changed when it has been closed after writing, or has got its name.
class FileWatch {
public:
    /// Files of one folder share a watch. Folders that can't be watched are left out.
    explicit FileWatch(const std::vector<std::string>& paths);
    ~FileWatch();
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;

    /// Readable when something has happened; -1 if the system has no inotify.
    int descriptor() const { return descriptor_; }
    /// The files that have changed since the last call. Does not wait.
    std::set<std::string> changed();

private:
    int descriptor_ = -1;
    std::map<int, std::map<std::string, std::string>> folders_;  // by watch: names and the paths they were given by
};

}  // namespace stratum::view
