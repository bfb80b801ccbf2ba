#include "view/file_watch.h"

#include <sys/inotify.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace stratum::view {

namespace fs = std::filesystem;

FileWatch::FileWatch(const std::vector<std::string>& paths) : descriptor_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    add(paths);
}

void FileWatch::add(const std::vector<std::string>& paths) {
    if (descriptor_ < 0) return;
    const std::lock_guard lock(mutex_);
    for (const std::string& path : paths)
        if (files_.try_emplace(path, identityOf(path)).second) arm(path);
}

FileWatch::~FileWatch() {
    if (descriptor_ >= 0) close(descriptor_);
}

// What another file at that path, or other bytes in it, would change; zeros if nothing is there. Pipes and devices have
// no size, and are not written and closed as files are: -1 tells them from an empty file.
FileWatch::Identity FileWatch::identityOf(const std::string& path) {
    struct stat facts {};
    if (stat(path.c_str(), &facts) != 0) return {};
    const bool sized = S_ISREG(facts.st_mode) || S_ISDIR(facts.st_mode);
    return {facts.st_dev, facts.st_ino, sized ? facts.st_size : -1, facts.st_mtim.tv_sec, facts.st_mtim.tv_nsec};
}

void FileWatch::watch(const std::string& place, std::uint32_t events, const std::string& name,
                      const std::string& path) {
    const int watch = inotify_add_watch(descriptor_, place.c_str(), events);
    if (watch >= 0) watches_[watch].insert({name, path});
}

// Again after each event, since other folders, links and files may stand there now: what is watched stays so.
void FileWatch::arm(const std::string& path) {
    constexpr int kMaxLinks = 40;  // as the system
    std::error_code failed;
    fs::path at = fs::absolute(path, failed);
    for (int link = 0; link < kMaxLinks && !failed; ++link) {
        fs::path folder = at.parent_path();
        fs::path name = at.filename();
        while (!fs::is_directory(folder, failed) && folder.has_relative_path()) {
            name = folder.filename();
            folder = folder.parent_path();
        }
        watch(folder.string(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_ONLYDIR, name.string(), path);
        failed.clear();
        if (!fs::is_symlink(at, failed)) break;
        const fs::path next = fs::read_symlink(at, failed);
        at = next.is_absolute() ? next : at.parent_path() / next;
    }
    watch(path, IN_CLOSE_WRITE, "", path);  // under any of its names
}

std::set<std::string> FileWatch::changed() {
    const std::lock_guard lock(mutex_);
    std::set<std::string> touched;
    std::set<std::string> written;
    alignas(inotify_event) std::array<char, 16384> buffer;
    while (true) {
        const ssize_t size = read(descriptor_, buffer.data(), buffer.size());
        if (size <= 0) break;
        for (ssize_t at = 0; at + static_cast<ssize_t>(sizeof(inotify_event)) <= size;) {
            inotify_event event{};
            std::memcpy(&event, buffer.data() + at, sizeof(event));
            const std::string name = event.len > 0 ? buffer.data() + at + sizeof(event) : "";
            at += static_cast<ssize_t>(sizeof(event) + event.len);
            const auto found = watches_.find(event.wd);
            if (found == watches_.end()) continue;
            for (const auto& [its_name, path] : found->second) {
                if (its_name != name) continue;
                touched.insert(path);
                if ((event.mask & (IN_CLOSE_WRITE | IN_MOVED_TO)) != 0) written.insert(path);
            }
            if ((event.mask & IN_IGNORED) != 0) watches_.erase(found);
        }
    }
    std::set<std::string> paths;
    for (const std::string& path : touched) {
        arm(path);
        // A file that was made just now is empty until it is written and closed; a link or a folder leads to a whole
        // one, or to a pipe.
        const Identity now = identityOf(path);
        const bool there = std::get<2>(now) != 0 && now != files_[path];
        if (!written.contains(path) && !there) continue;
        files_[path] = now;
        paths.insert(path);
    }
    return paths;
}

}  // namespace stratum::view
