// Lines of the G-code around one of them.
#pragma once

#include "assemble/print/print_levels.h"
#include "gcode/container/container.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::view {

struct ProgramLine {
    std::uint32_t number = 0;  ///< from 1
    std::string text;          ///< without its end; cut after a few hundred bytes, with anything but ASCII replaced
};

/// The text of a program and where its lines begin.
class ProgramText {
public:
    /// Reads the file, and unpacks it if it must be. Throws InputError.
    ProgramText(const std::string& path, const voxelize::PrintOptions& options);

    /// The lines number - around to number + around, as far as they are there.
    std::vector<ProgramLine> around(std::uint32_t number, std::uint32_t around) const;
    /// Lines with a text, small and large letters alike.
    struct Found {
        std::uint32_t line = 0;  ///< the next one behind `line`, or the last one before it; else from the other end
        std::size_t place = 0;   ///< of it among them, from 1
        std::size_t count = 0;   ///< of all; 0: `line` is none
    };
    Found find(std::string_view text, std::uint32_t line, bool back) const;
    const std::string& path() const { return path_; }
    std::size_t bytes() const { return program_.text.size(); }

private:
    std::string path_;
    std::optional<gcode::InputBytes> file_;  // empty if the text is unpacked
    gcode::Program program_;
    std::vector<std::size_t> marks_;  // where every kLinesAMark-th line begins
};

/// The last program that was asked for stays unpacked, unless it is large.
class KeptProgram {
public:
    static constexpr std::size_t kMostBytes = std::size_t{128} << 20;
    explicit KeptProgram(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}

    /// As ProgramText::around().
    std::vector<ProgramLine> around(const std::string& path, const voxelize::PrintOptions& options,
                                    std::uint32_t number, std::uint32_t around);
    /// As ProgramText::find().
    ProgramText::Found find(const std::string& path, const voxelize::PrintOptions& options, std::string_view text,
                            std::uint32_t line, bool back);
    /// As around(), as JSON for a page, four lines before and after.
    nlohmann::json around(const std::string& path, const voxelize::PrintOptions& options, std::uint32_t number);
    void forget() { text_.reset(); }

private:
    const ProgramText& textOf(const std::string& path, const voxelize::PrintOptions& options);
    void leave();

    std::size_t most_bytes_;
    std::unique_ptr<ProgramText> text_;
};

}  // namespace stratum::view
