#include "animate/kept_frames.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/own_file.h"
#include "shade/film/png.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <system_error>
#include <utility>

namespace stratum::animate {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".png";
constexpr std::size_t kSceneDigits = 16;

// "000012-0123456789abcdef.png"
bool isFrameName(const std::string& name) {
    const std::size_t dash = name.find('-');
    if (dash == std::string::npos || !name.ends_with(kEnding)) return false;
    const auto all = [&name](std::size_t from, std::size_t to, std::string_view digits) {
        return to > from && name.find_first_not_of(digits, from) >= to;
    };
    return all(0, dash, "0123456789") && name.size() == dash + 1 + kSceneDigits + kEnding.size() &&
           all(dash + 1, dash + 1 + kSceneDigits, "0123456789abcdef");
}

}  // namespace

KeptFrames::KeptFrames(fs::path folder, const std::string& scene, int width, int height)
    : folder_(std::move(folder)), scene_(scene.substr(0, kSceneDigits)), width_(width), height_(height) {}

fs::path KeptFrames::pathOf(std::size_t frame) const {
    return folder_ / fmt::format("{:06}-{}{}", frame, scene_, kEnding);
}

bool KeptFrames::has(std::size_t frame) const {
    std::error_code missing;
    return fs::is_regular_file(pathOf(frame), missing);
}

std::optional<std::vector<std::uint8_t>> KeptFrames::read(std::size_t frame) const {
    if (!has(frame)) return std::nullopt;
    try {
        const InputFile file(pathOf(frame));
        auto pixels = shade::decodePng(file.bytes());
        if (pixels && pixels->width == width_ && pixels->height == height_) return std::move(pixels->rgb);
    } catch (const InputError&) {
        // It was removed, or can't be read: it is made anew.
    }
    return std::nullopt;
}

void KeptFrames::keep(std::size_t frame, const std::vector<std::uint8_t>& rgb) const {
    std::error_code error;
    fs::create_directory(folder_, error);
    if (error)
        throw OutputError(fmt::format("{}: can't be made ({}); finished frames are kept there until the film is whole",
                                      folder_.string(), error.message()));
    // A damaged one may have lost its mark; by its name it is one of these.
    const Replacement may(pathOf(frame));
    AtomicFile(pathOf(frame)).write([&](const fs::path& to) {
        shade::writePng(to, width_, height_, rgb, {{"Software", kProgramMark}});
    });
}

void KeptFrames::remove() const {
    std::error_code error;
    std::vector<fs::path> frames;
    for (fs::directory_iterator file(folder_, error), end; !error && file != end; file.increment(error))
        if (isFrameName(file->path().filename().string())) frames.push_back(file->path());
    for (const fs::path& frame : frames) fs::remove(frame, error);
    fs::remove(folder_, error);  // fails if something else is in it
}

}  // namespace stratum::animate
