#include "view/file_watch.h"

#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace stratum::view {

namespace fs = std::filesystem;

FileWatch::FileWatch(const std::vector<std::string>& paths) : descriptor_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    if (descriptor_ < 0) return;
    for (const std::string& path : paths) {
        std::error_code failed;
        const fs::path absolute = fs::absolute(path, failed);
        if (failed) continue;
        const int watch =
            inotify_add_watch(descriptor_, absolute.parent_path().c_str(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_ONLYDIR);
        if (watch >= 0) folders_[watch][absolute.filename().string()] = path;
    }
}

FileWatch::~FileWatch() {
    if (descriptor_ >= 0) close(descriptor_);
}

std::set<std::string> FileWatch::changed() {
    std::set<std::string> paths;
    alignas(inotify_event) std::array<char, 16384> buffer;
    while (true) {
        const ssize_t size = read(descriptor_, buffer.data(), buffer.size());
        if (size <= 0) return paths;
        for (ssize_t at = 0; at + static_cast<ssize_t>(sizeof(inotify_event)) <= size;) {
            inotify_event event{};
            std::memcpy(&event, buffer.data() + at, sizeof(event));
            const char* const name = buffer.data() + at + sizeof(event);
            at += static_cast<ssize_t>(sizeof(event) + event.len);
            const auto folder = folders_.find(event.wd);
            if (folder == folders_.end() || event.len == 0) continue;
            const auto file = folder->second.find(name);
            if (file != folder->second.end()) paths.insert(file->second);
        }
    }
}

}  // namespace stratum::view
