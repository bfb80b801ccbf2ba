// Progress and warnings while files are read.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::assemble {

/// A problem of an input that is used nevertheless.
struct Warning {
    enum class Kind {
        program,      ///< of a line of the G-code
        voxel_size,   ///< the voxels are too large for what is printed
        narrow_band,  ///< a level set holds fewer values around its surface than it should
        color_by,     ///< what is coloured by is not known, everywhere or somewhere
        camera,       ///< it is within the plastic
    };
    Kind kind = Kind::program;
    std::string text;  ///< one line, without the name of the program that reads
};

/// Callbacks, one at a time, on the thread that called the library. Each may be empty. Exceptions end the reading and
/// are passed on; end() must not throw.
struct ReadEvents {
    /// A step begins: "reading", "loading", "laying out", "preparing". Steps do not overlap.
    /// @param measured  fraction() is called during the step
    std::function<void(std::string_view step, bool measured)> begin;
    std::function<void(double done)> fraction;  ///< of the step, 0..1; now and then
    std::function<void()> end;                  ///< of the step, also if it failed
    /// Called immediately, so that a warning is reported even if a later step fails. The result holds all warnings,
    /// too.
    std::function<void(const Warning&)> warning;
};

/// One step, from construction to destruction. Keeps a reference to `events`.
class Step {
public:
    Step(const ReadEvents& events, std::string_view name, bool measured = false) : events_(events) {
        if (events_.begin) events_.begin(name, measured);
    }
    ~Step() {
        if (events_.end) events_.end();
    }
    Step(const Step&) = delete;
    Step& operator=(const Step&) = delete;

private:
    const ReadEvents& events_;
};

/// Warnings of one reading: kept for the result, and reported immediately. Keeps a reference to `events`.
class Warnings {
public:
    explicit Warnings(const ReadEvents& events) : events_(events) {}
    void add(Warning::Kind kind, std::string text) {
        all_.push_back({kind, std::move(text)});
        if (events_.warning) events_.warning(all_.back());
    }
    const std::vector<Warning>& all() const { return all_; }

private:
    const ReadEvents& events_;
    std::vector<Warning> all_;
};

}  // namespace stratum::assemble
