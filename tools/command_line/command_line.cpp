#include "command_line.h"

#include "base/json_text.h"
#include "build_facts.h"
#include "early_failure.h"
#include "manual.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/names.h"
#include "base/own_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <new>

namespace stratum::tools {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kBadInput = 3;

int complain(const CLI::App& app, std::string_view message, int status) {
    tellError(fmt::format("{}: {}\n", app.get_name(), message));
    return status;
}

// A file that is opened while standard output or error is closed would get its number, and what is said to people with
// it. Opened for reading, they fail when they are written to, as closed ones do.
void openStandardStreams() {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        while (::fcntl(descriptor, F_GETFD) < 0 && ::open("/dev/null", O_RDONLY) >= 0) continue;
}

// The app of the subcommand that is asked for, or the one itself.
const CLI::App& deepest(const CLI::App& app) {
    const auto verbs = app.get_subcommands();
    return verbs.empty() ? app : *verbs.front();
}

std::string unknownWord(const CLI::App& app, const CLI::ExtrasError& error) {
    const std::vector<std::string> words = app.remaining(true);
    if (words.empty()) return error.what();
    const std::string word = words.front().substr(0, words.front().find('='));
    std::vector<std::string> names;
    for (const CLI::Option* option : deepest(app).get_options())
        if (!option->get_group().empty())
            for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    const std::vector<std::string_view> views(names.begin(), names.end());
    return fmt::format("{}: {}{} (see {} -h)", word, word.starts_with('-') ? "no such option" : "not expected here",
                       didYouMean(word, views), app.get_name());
}

// The first word of a tool of many verbs, if it is none of them.
std::string unknownVerb(const CLI::App& app, const char* word) {
    if (app.get_require_subcommand_min() == 0 || word[0] == '-') return {};
    std::vector<std::string_view> names;
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
        names.emplace_back(verb->get_name());
    if (std::find(names.begin(), names.end(), word) != names.end()) return {};
    return fmt::format("{}: is none of {}{}", word, fmt::join(names, ", "), didYouMean(word, names));
}

// -o=a.png would be a file named "=a.png".
std::string shortWithEquals(const CLI::App& app, int argc, char** argv) {
    std::vector<const CLI::Option*> options = app.get_options();
    for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
        for (const CLI::Option* option : verb->get_options()) options.push_back(option);
    for (int n = 1; n < argc; ++n) {
        const std::string_view word = argv[n];
        if (word.size() < 3 || word[0] != '-' || word[2] != '=') continue;
        for (const CLI::Option* option : options)
            if (option->check_sname(std::string(1, word[1])) && !option->get_lnames().empty())
                return fmt::format("{}: a short option takes its value as the next word: write -{} {} or --{}={}", word,
                                   word[1], word.substr(3), option->get_lnames().front(), word.substr(3));
    }
    return {};
}

}  // namespace

void addCommonOptions(CLI::App& app, CommonOptions& options, const Brief& brief) {
    app.add_option("--threads", options.threads, "Threads to use (default: all the machine has)")
        ->check(CLI::Range(1, 1024))
        ->type_name("N")
        ->group("General");
    app.add_option("--stats", options.stats, "Write a JSON report; - is standard output")
        ->type_name("FILE")
        ->group("General");
    app.add_flag_callback(
           "--force", [] { Replacement::guard(false); }, "Replace existing files that this program did not write")
        ->group("General");
    app.add_flag("--quiet", options.quiet, "Print nothing but errors")->group("General");
    addVersion(app);
    addManual(app, brief);
}

void addGone(CLI::App& app, const std::string& option, const std::string& instead) {
    app.add_option_function<std::string>(
           option,
           [option, instead](const std::string&) {
               throw UsageError(fmt::format("{}: is no option any more: {}", option, instead));
           })
        ->group("");
}

void addVersion(CLI::App& app) {
    app.add_flag_callback(
           "--version", [&app] { throw CLI::CallForVersion(buildFacts(app.get_name()), 0); },
           "The version, how it was built and with what")
        ->group("General");
}

void useHugePages(char** argv) {
#if defined(__GLIBC__) && !defined(STRATUM_SANITIZED)
    if (std::getenv("GLIBC_TUNABLES") != nullptr) return;
    // By its own path: through /proc the process would be listed as "exe".
    std::error_code failed;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (failed) return;
    ::setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 1);
    // Returns only if it fails; then everything works as before, slower.
    ::execv(self.c_str(), argv);
#else
    static_cast<void>(argv);
#endif
}

void keepFreedMemory() {
#if defined(__GLIBC__) && !defined(STRATUM_SANITIZED)
    constexpr int kNever = std::numeric_limits<int>::max();
    constexpr int kLargest = 32 << 20;  // that the C library accepts
    ::mallopt(M_TRIM_THRESHOLD, kNever);
    ::mallopt(M_MMAP_THRESHOLD, kLargest);
#endif
}

Failure currentFailure() {
    try {
        throw;
    } catch (const UsageError& error) {
        return {error.what(), kWrongUsage};
    } catch (const InputError& error) {
        return {error.what(), kBadInput};
    } catch (const BatchFailure& error) {
        return {error.what(), error.status()};
    } catch (const std::bad_alloc&) {
        return {"out of memory; choose a larger voxel or a smaller picture", kFailed};
    } catch (const std::exception& error) {
        return {error.what(), kFailed};
    }
}

int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
    mainHasBegun();
    openStandardStreams();
    Replacement::guard(true);
    AtomicFile::removeOnSignals();
    if (argc == 1) {
        tellError(shortUsage(app));
        return kWrongUsage;
    }
    if (const std::string slip = shortWithEquals(app, argc, argv); !slip.empty())
        return complain(app, slip, kWrongUsage);
    if (const std::string slip = unknownVerb(app, argv[1]); !slip.empty()) return complain(app, slip, kWrongUsage);
    int status = 0;
    bool parsed = false;
    try {
        app.parse(argc, argv);
        parsed = true;
        body();
    } catch (const CLI::Success& request) {
        app.exit(request);
    } catch (const CLI::ExtrasError& error) {
        return complain(app, unknownWord(app, error), kWrongUsage);
    } catch (const CLI::ParseError& error) {
        return complain(app, fmt::format("{} (see {} -h)", error.what(), app.get_name()), kWrongUsage);
    } catch (...) {
        const Failure failure = currentFailure();
        // Whatever a check of an option throws is about that option.
        status = complain(app, failure.message, !parsed && failure.status == kFailed ? kWrongUsage : failure.status);
    }
    // What a full disk has not taken shows here at the latest. (std::cout is CLI11's way to say what it is asked for.)
    std::cout.flush();
    if ((!std::cout || std::fflush(stdout) != 0 || std::ferror(stdout) != 0) && status == 0)
        return complain(app, "standard output: could not be written; is the disk full?", kFailed);
    return status;
}

ThreadLimit::ThreadLimit(int threads) : threads_(threads > 0 ? threads : tbb::info::default_concurrency()) {
    control_ = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                     static_cast<std::size_t>(threads_));
}

ThreadLimit::~ThreadLimit() = default;

std::size_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

void writeStats(const CommonOptions& options, const nlohmann::ordered_json& report) {
    if (options.stats.empty()) return;
    // File names need not be UTF-8; a report must not fail over one.
    const auto mark = [](const nlohmann::ordered_json& one) {
        nlohmann::ordered_json marked{{"program", kProgramMark}};
        marked.update(one);
        return marked;
    };
    nlohmann::ordered_json marked = nlohmann::ordered_json::array();  // one of each input
    if (report.is_array())
        for (const nlohmann::ordered_json& one : report) marked.push_back(mark(one));
    else
        marked = mark(report);
    const std::string text = jsonText(marked, 2) + "\n";
    if (options.stats == "-") {
        if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
            throw OutputError("--stats -: standard output could not be written; is the disk full?");
        return;
    }
    writeFile(options.stats, text);
}

void tellError(std::string_view text) {
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
    static_cast<void>(std::fflush(stderr));
}

void say(const CommonOptions& options, std::string_view line) {
    if (options.quiet) return;
    // A full disk is told of once, at the end.
    const std::string text = fmt::format("{}\n", line);
    std::FILE* stream = options.stats == "-" || options.output_on_stdout ? stderr : stdout;
    static_cast<void>(std::fwrite(text.data(), 1, text.size(), stream));
    static_cast<void>(std::fflush(stream));  // in a log it stands before the warnings that follow
}

}  // namespace stratum::tools
