// An input that pages look at: what is kept of it from one picture to the next, and what can be said of it.
#pragma once

#include "assemble/print/kept_prints.h"
#include "gcode/toolpath/toolpath.h"
#include "view/asked/message.h"
#include "view/asked/picture_plan.h"
#include "view/input/program_lines.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace stratum::view {

/// For one thread at a time.
class Document {
public:
    explicit Document(GivenInput given);

    const GivenInput& given() const { return given_; }
    assemble::KeptPrints& kept() { return kept_; }

    /// Files whose change makes it another: the input and what its scene names.
    std::vector<std::string> files() const;
    /// Reads the scene again that was given, if its files have changed. Throws InputError, also as requireFiles() does
    /// for files that it names now.
    void update();
    /// Throws InputError if one of them is a pipe or a device: nobody may ever write into that.
    void requireFiles() const;
    /// Another one after each change of those files; no other document and no other viewer has the same.
    std::uint64_t generation() const { return generation_; }
    /// Forgets what was read: the files have changed.
    void forget();

    /// The G-code of an object; null if that is no print, or was not read yet.
    std::shared_ptr<const gcode::Toolpath> toolpath(std::size_t object) const;
    /// With times by bead, which are computed when first asked for: reads the file once more. Null as above. Throws
    /// InputError.
    std::shared_ptr<const gcode::Toolpath> timedToolpath(std::size_t object);

    /// By layer number the height of its top in mm and the seconds that it takes, which are computed when first asked
    /// for. Throws InputError, also if the input is no print.
    nlohmann::json layers();
    /// The line of a bead, and those around it. Throws InputError.
    nlohmann::json programAt(std::uint32_t bead);
    /// The line that is asked for, those around it, how many there are of a text and which of them it is, and the bead
    /// that is laid there, or last before it. Throws InputError.
    nlohmann::json find(const FindMessage& find);
    /// The lines of an object's program around one of them. Throws InputError.
    nlohmann::json linesAround(std::size_t object, std::uint32_t line);
    /// What the page offers: layers, features, objects, tools, attributes. Of the first print, if there is one.
    nlohmann::json facts() const;

private:
    GivenInput given_;
    assemble::KeptPrints kept_;
    KeptProgram program_;
    bool outdated_;  // given_ is
    std::uint64_t generation_;
};

}  // namespace stratum::view
