// What all tools share: the common options, exit statuses and the report file.
#pragma once

#include "base/human_text.h"
#include "base/stopwatch.h"
#include "manual.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace tbb::detail::d1 {
class global_control;
}

namespace stratum::tools {

/// --threads, --stats, --force, --quiet, --version.
struct CommonOptions {
    int threads = 0;    ///< 0: as many as the machine has
    std::string stats;  ///< file for the JSON report, "-" is standard output, empty is none
    bool quiet = false;
    bool output_on_stdout = false;  ///< -o -: what is said goes to stderr then
};

/// Adds the common options and the manual (manual.h) to a command line. -h shows the options of `brief`; all, if empty.
void addCommonOptions(CLI::App& app, CommonOptions& options, const Brief& brief = {});

/// Declares an option that a former version had, with one value. Whoever gives it is told what to do instead; help and
/// completion do not show it.
void addGone(CLI::App& app, const std::string& option, const std::string& instead);

/// Adds --version alone.
void addVersion(CLI::App& app);

/// For tools that fill large grids: touching fresh memory a small page at a time is what that spends most of its time
/// on. The C library can ask for huge pages, but only if it is told before it starts: so the process starts itself once
/// more. To be called before anything else is done.
void useHugePages(char** argv);

/// For tools that make many pictures or passes of the same size and then end: the C library keeps freed memory for the
/// next pass. Otherwise it gives each pass's memory back to the system and asks for it again.
void keepFreedMemory();

/// What an exception says, and the exit status that it means.
struct Failure {
    std::string message;
    int status = 1;
};

/// Of the exception that is being handled.
Failure currentFailure();

/// Some inputs of several failed; what they lacked has been said.
class BatchFailure : public std::runtime_error {
public:
    BatchFailure(const std::string& text, int status) : std::runtime_error(text), status_(status) {}
    int status() const { return status_; }

private:
    int status_;
};

/// Parses, runs `body` and turns what escapes, also from checks of options, into a message on stderr and an exit
/// status: 0 done, 1 failed, 2 wrong usage, 3 bad input. Without any argument: a short usage, and 2.
int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& body);

/// Limits TBB to --threads for as long as it lives.
class ThreadLimit {
public:
    explicit ThreadLimit(int threads);
    ~ThreadLimit();
    ThreadLimit(const ThreadLimit&) = delete;
    ThreadLimit& operator=(const ThreadLimit&) = delete;
    int threads() const { return threads_; }

private:
    int threads_;
    std::unique_ptr<tbb::detail::d1::global_control> control_;
};

/// Largest resident set of this process so far, bytes.
std::size_t peakRssBytes();

/// Writes the report where --stats says; does nothing if it says nothing. Throws OutputError.
void writeStats(const CommonOptions& options, const nlohmann::ordered_json& report);

/// Writes to stderr. Does nothing where that is closed or full: then nobody listens.
void tellError(std::string_view text);

/// A line of the summary for people: to stdout, or to stderr if stdout carries the report or the output; nothing if
/// quiet.
void say(const CommonOptions& options, std::string_view line);

}  // namespace stratum::tools
