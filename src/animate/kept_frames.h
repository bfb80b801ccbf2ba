// Finished frames of a film, kept until it is whole: a run that was stopped goes on, and several processes share one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace stratum::animate {

/// A folder of PNG files, whose names have the number of the frame and what it is of: frames of another scene are not
/// taken for it. Several processes may write into one folder.
class KeptFrames {
public:
    /// @param folder  made with the first frame
    /// @param scene   hexadecimal digits: a hash of all that the frames depend on, at least 16
    KeptFrames(std::filesystem::path folder, const std::string& scene, int width, int height);

    /// The pixels of a frame, 8-bit RGB row by row; nothing if it is not there, damaged or of another size.
    std::optional<std::vector<std::uint8_t>> read(std::size_t frame) const;
    /// Whether it is there.
    bool has(std::size_t frame) const;
    /// Writes a frame. Throws OutputError.
    void keep(std::size_t frame, const std::vector<std::uint8_t>& rgb) const;
    /// Removes all frames, also those of other scenes, and the folder if nothing else is in it.
    void remove() const;

    const std::filesystem::path& folder() const { return folder_; }

private:
    std::filesystem::path pathOf(std::size_t frame) const;

    std::filesystem::path folder_;
    std::string scene_;
    int width_, height_;
};

}  // namespace stratum::animate
