#include "command_line.h"

#include "build_facts.h"
#include "manual.h"

#include "io/atomic_file.h"
#include "io/error.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>

namespace stratum::tools {
namespace {

constexpr int kFailed = 1;
constexpr int kWrongUsage = 2;
constexpr int kBadInput = 3;

int complain(const CLI::App& app, std::string_view message, int status) {
    fmt::print(stderr, "{}: {}\n", app.get_name(), message);
    return status;
}

}  // namespace

void addCommonOptions(CLI::App& app, CommonOptions& options, const std::vector<std::string>& brief) {
    app.add_option("--threads", options.threads, "Threads to use (default: all the machine has)")
        ->check(CLI::Range(1, 1024))
        ->type_name("N")
        ->group("General");
    app.add_option("--stats", options.stats, "Write a JSON report; - is standard output")
        ->type_name("FILE")
        ->group("General");
    app.add_flag("--quiet", options.quiet, "Print nothing but errors")->group("General");
    addVersion(app);
    addManual(app, brief);
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

int runTool(CLI::App& app, int argc, char** argv, const std::function<void()>& body) {
    AtomicFile::removeOnSignals();
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& request) {
        return app.exit(request);
    } catch (const CLI::ParseError& error) {
        return complain(app, fmt::format("{} (see {} -h)", error.what(), app.get_name()), kWrongUsage);
    }
    try {
        body();
        return 0;
    } catch (const UsageError& error) {
        return complain(app, error.what(), kWrongUsage);
    } catch (const InputError& error) {
        return complain(app, error.what(), kBadInput);
    } catch (const std::bad_alloc&) {
        return complain(app, "out of memory; choose a larger voxel or a smaller picture", kFailed);
    } catch (const std::exception& error) {
        return complain(app, error.what(), kFailed);
    }
}

ThreadLimit::ThreadLimit(int threads) : threads_(threads > 0 ? threads : tbb::info::default_concurrency()) {
    control_ = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                     static_cast<std::size_t>(threads_));
}

ThreadLimit::~ThreadLimit() = default;

ProgressBar::ProgressBar(std::string label, bool quiet)
    : label_(std::move(label)),
      visible_(!quiet && ::isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      shown_(start_) {}

ProgressBar::~ProgressBar() {
    if (visible_) fmt::print(stderr, "\r\033[K");
}

void ProgressBar::show(double fraction) {
    using namespace std::chrono;
    const auto now = steady_clock::now();
    // Ten times a second is smooth; quick work shows nothing at all.
    if (!visible_ || now - shown_ < milliseconds(100)) return;
    shown_ = now;
    constexpr int kWidth = 32;
    const int filled = std::clamp(static_cast<int>(fraction * kWidth), 0, kWidth);
    const double seconds = duration<double>(now - start_).count();
    const double left = fraction > 0.01 ? seconds / fraction - seconds : 0;
    std::string bar;
    for (int i = 0; i < kWidth; ++i) bar += i < filled ? "━" : "─";
    fmt::print(stderr, "\r\033[K{:<12} {} {:3.0f} %  {:.0f} s left", label_, bar, fraction * 100, left);
    std::fflush(stderr);
}

std::function<void(double)> ProgressBar::callback() {
    if (!visible_) return {};
    return [this](double fraction) { show(fraction); };
}

double Stopwatch::lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
}

std::size_t peakRssBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

void writeStats(const CommonOptions& options, const nlohmann::ordered_json& report) {
    if (options.stats.empty()) return;
    // File names need not be UTF-8; a report must not fail over one.
    const std::string text = report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    if (options.stats == "-") {
        std::fwrite(text.data(), 1, text.size(), stdout);
        std::fflush(stdout);
        return;
    }
    AtomicFile file(options.stats);
    std::ofstream stream(file.temporary(), std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) throw OutputError(fmt::format("{}: could not be written; is the disk full?", options.stats));
    file.commit();
}

void say(const CommonOptions& options, std::string_view line) {
    if (!options.quiet) fmt::print(options.stats == "-" ? stderr : stdout, "{}\n", line);
}

std::string humanBytes(double bytes) {
    if (bytes >= 1e9) return fmt::format("{:.2f} GB", bytes * 1e-9);
    if (bytes >= 1e6) return fmt::format("{:.1f} MB", bytes * 1e-6);
    if (bytes >= 1e3) return fmt::format("{:.1f} kB", bytes * 1e-3);
    return fmt::format("{:.0f} B", bytes);
}

std::string humanCount(double count) {
    if (count >= 1e6) return fmt::format("{:.1f} M", count * 1e-6);
    if (count >= 1e4) return fmt::format("{:.1f} k", count * 1e-3);
    return fmt::format("{:.0f}", count);
}

}  // namespace stratum::tools
