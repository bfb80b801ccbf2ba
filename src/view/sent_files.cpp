#include "view/sent_files.h"

#include "base/error.h"
#include "base/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>

namespace stratum::view {
namespace {

namespace fs = std::filesystem;

std::uint64_t bytesIn(const fs::path& folder) {
    std::uint64_t sum = 0;
    std::error_code error;
    for (auto each = fs::recursive_directory_iterator(folder, error); !error && each != fs::end(each);
         each.increment(error)) {
        std::error_code gone;
        const std::uint64_t bytes = each->is_regular_file(gone) ? each->file_size(gone) : 0;
        if (!gone) sum += bytes;
    }
    return sum;
}

// The last part of a path of any system, on one line, as long as file systems take it.
std::string nameOf(std::string_view text) {
    constexpr std::size_t kMostName = 200;  // bytes; the end says what it is
    text = text.substr(std::min(text.size(), text.find_last_of("/\\") + 1));
    text.remove_prefix(text.size() - std::min(text.size(), kMostName));
    text.remove_prefix(std::min(text.size(), text.find_first_not_of(". ")));
    std::string name = onOneLine(text);
    return name.empty() ? "print.gcode" : name;
}

fs::path ownFolder() {
    std::error_code none;  // TMPDIR may name no folder
    std::string folder = (fs::temp_directory_path(none) / "vdbview-XXXXXX").string();
    if (none || mkdtemp(folder.data()) == nullptr)
        throw InputError(folder + ": can't be made; name files on the command line");
    return folder;
}

}  // namespace

SentFiles::~SentFiles() {
    std::error_code ignored;
    if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

fs::path SentFiles::place(std::string_view name) {
    if (folder_.empty()) folder_ = ownFolder();
    if (count_ >= kMostFiles || bytesIn(folder_) >= kMostOfAll)
        throw InputError(fmt::format("{} files with {} GB were sent, which is the most; start vdbview again", count_,
                                     bytesIn(folder_) >> 30));
    const fs::path own = folder_ / std::to_string(++count_);
    std::error_code error;
    fs::create_directory(own, error);
    if (error) throw InputError(fmt::format("{}: can't be made: {}", own.string(), error.message()));
    return own / nameOf(name);
}

void SentFiles::remove(const fs::path& path) {
    std::error_code ignored;
    fs::remove_all(path.parent_path(), ignored);
}

}  // namespace stratum::view
