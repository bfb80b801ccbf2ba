#include "shade/parts/frame_record.h"

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/own_file.h"

#include <fstream>
#include <utility>

namespace stratum::shade {

FrameRecord::FrameRecord(std::filesystem::path path) : path_(std::move(path)) {
    std::ifstream in(path_);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with('#')) continue;  // whose file it is
        const std::size_t first = line.find(' ');
        const std::size_t second = first == std::string::npos ? first : line.find(' ', first + 1);
        if (second == std::string::npos) continue;
        entries_[line.substr(second + 1)] = {line.substr(0, first), line.substr(first + 1, second - first - 1)};
    }
}

bool FrameRecord::has(const std::filesystem::path& picture, const std::string& scene) const {
    const auto found = entries_.find(picture.filename().string());
    if (found == entries_.end() || found->second.scene != scene) return false;
    try {
        return sha256Hex(InputFile(picture).bytes()) == found->second.bytes;
    } catch (const InputError&) {
        return false;  // it was removed
    }
}

void FrameRecord::add(const std::filesystem::path& picture, const std::string& scene) {
    entries_[picture.filename().string()] = {scene, sha256Hex(InputFile(picture).bytes())};
    std::string text = std::string("# by ") + kProgramMark + '\n';
    for (const auto& [name, entry] : entries_) text += entry.scene + ' ' + entry.bytes + ' ' + name + '\n';
    const Replacement may(path_);  // a damaged one may have lost its mark
    writeFile(path_, text);
}

}  // namespace stratum::shade
