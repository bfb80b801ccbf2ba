// What a caller may hear while files are read: which step goes on, how far it is, and warnings.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::assemble {

/// Something is odd about an input, and it is used all the same.
struct Warning {
    enum class Kind {
        program,      ///< of a line of the G-code
        voxel_size,   ///< the voxels are too large for what is printed
        narrow_band,  ///< a level set holds fewer values around its surface than it should
    };
    Kind kind = Kind::program;
    std::string text;  ///< one line, without the name of the program that reads
};

/// Functions that are called while files are read, one at a time, from the thread that called the library. Each may be
/// empty. What they throw ends the reading and is passed on; end() must not throw.
struct ReadEvents {
    /// A step begins: "reading", "loading", "laying out", "preparing". Steps do not overlap.
    /// @param measured  fraction() is called meanwhile
    std::function<void(std::string_view step, bool measured)> begin;
    std::function<void(double done)> fraction;  ///< of the step, 0..1; now and then
    std::function<void()> end;                  ///< of the step, also if it failed
    /// At once, so that a warning is heard even if a later step fails. The result holds the same warnings again.
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

/// Warnings of one reading: kept for the result, and told at once. Keeps a reference to `events`.
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
