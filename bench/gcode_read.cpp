// How fast G-code is read, beside `wc -l` and zlib's inflate on the same bytes in the same run, and in how much memory.
//
//   bench_gcode_read FILE [ROUNDS]
//
// FILE is text or any container; it is unpacked first, and the text alone is measured. Rounds alternate between the
// three, and CPU seconds of one thread are counted, so that other work on the machine disturbs all alike. The text is
// mapped and warm. Prints a row of docs/benchmarks.md for each.
#include "base/error.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "gcode/reader.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <fcntl.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace stratum;

double seconds(const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double cpuSeconds(int who) {
    rusage usage{};
    getrusage(who, &usage);
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

[[noreturn]] void fail(std::string_view what) {
    fmt::print(stderr, "bench_gcode_read: {}\n", what);
    std::exit(1);
}

// A value of /proc/self/status in bytes.
std::size_t status(std::string_view key) {
    std::ifstream file("/proc/self/status");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with(key)) return std::strtoull(line.c_str() + key.size(), nullptr, 10) * 1024;
    fail("no /proc/self/status");
}

// The text as a file of its own, so that it can be mapped and given to wc; gone when the program ends.
class TextFile {
public:
    explicit TextFile(const std::filesystem::path& source)
        : path_(std::filesystem::temp_directory_path() / fmt::format("gcode_read_{}.gcode", getpid())) {
        const InputFile file(source);
        const gcode::Program program = gcode::openContainer(file.bytes(), source.string());
        std::ofstream(path_, std::ios::binary)
            .write(program.text.data(), static_cast<std::streamsize>(program.text.size()));
    }
    ~TextFile() { std::filesystem::remove(path_); }
    TextFile(const TextFile&) = delete;
    TextFile& operator=(const TextFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

void countLines(const std::filesystem::path& path) {
    const pid_t child = fork();
    if (child < 0) fail("can't fork");
    if (child == 0) {
        const int null = open("/dev/null", O_WRONLY);
        dup2(null, STDOUT_FILENO);
        execlp("wc", "wc", "-l", path.c_str(), nullptr);
        _exit(127);
    }
    int result = 0;
    waitpid(child, &result, 0);
    if (result != 0) fail("wc -l failed");
}

std::vector<Bytef> deflated(std::string_view text) {
    uLongf size = compressBound(text.size());
    std::vector<Bytef> packed(size);
    if (compress2(packed.data(), &size, reinterpret_cast<const Bytef*>(text.data()), text.size(), 6) != Z_OK)
        fail("zlib can't deflate");
    packed.resize(size);
    return packed;
}

struct Contest {
    std::string name;
    int who;  // whose CPU time counts
    std::function<void()> work;
    std::vector<double> seconds{};
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

void run(const std::filesystem::path& source, int rounds) {
    const TextFile text_file(source);
    const InputFile file(text_file.path());
    const std::string_view text = file.bytes();
    unsigned touched = 0;
    for (const char c : text) touched += static_cast<unsigned char>(c);

    // Memory first, while nothing freed lies about: the peak of reading once, beyond what is resident before, which
    // includes the code.
    const gcode::Toolpath few = gcode::readToolpath("M83\nG1 Z.2\nG1 X9 E1\nG2 X0 I-4.5 E1\n", "few");
    std::ofstream("/proc/self/clear_refs") << 5;  // starts VmHWM anew
    const std::size_t before = status("VmRSS:");
    const gcode::Toolpath toolpath = gcode::readToolpath(text, "text");
    const auto beads = static_cast<double>(toolpath.beads.size());
    const double peak = static_cast<double>(status("VmHWM:") - before) / beads;
    fmt::print("{}: {:.1f} MB of text, {} beads, {} arcs among them, {} runs (checksum {:x})\n",
               source.filename().string(), static_cast<double>(text.size()) * 1e-6, toolpath.beads.size(),
               toolpath.arcs.size(), toolpath.runs.size(), touched + few.beads.size());

    const std::vector<Bytef> packed = deflated(text);
    std::vector<Bytef> unpacked(text.size());
    std::vector<Contest> contests{
        {"readToolpath", RUSAGE_SELF, [&] { gcode::readToolpath(text, "text"); }},
        {"wc -l", RUSAGE_CHILDREN, [&] { countLines(text_file.path()); }},
        {"zlib inflate", RUSAGE_SELF,
         [&] {
             uLongf size = unpacked.size();
             if (uncompress(unpacked.data(), &size, packed.data(), packed.size()) != Z_OK) fail("zlib can't inflate");
         }},
    };
    for (int round = 0; round < rounds; ++round)
        for (Contest& contest : contests) {
            const double start = cpuSeconds(contest.who);
            contest.work();
            contest.seconds.push_back(cpuSeconds(contest.who) - start);
        }
    const double own = median(contests[0].seconds);
    const auto rate = [&](double time) { return static_cast<double>(text.size()) * 1e-6 / time; };
    for (const Contest& contest : contests) {
        const auto [least, most] = std::minmax_element(contest.seconds.begin(), contest.seconds.end());
        fmt::print("| {} | {:.0f} ({:.0f} to {:.0f}) | {:.2f} |\n", contest.name, rate(median(contest.seconds)),
                   rate(*most), rate(*least), own / median(contest.seconds));
    }
    fmt::print("peak beyond the map: {:.2f} bytes a bead; a bead is {}, an arc {}, a run {}\n", peak,
               sizeof(gcode::Bead), sizeof(gcode::Arc), sizeof(gcode::Run));
}

}  // namespace

int main(int argc, char** argv) {
    const int rounds = argc > 2 ? std::atoi(argv[2]) : 15;
    if (argc < 2 || rounds < 1) fail("usage: bench_gcode_read FILE [ROUNDS]");
    try {
        run(argv[1], rounds);
    } catch (const std::exception& error) {
        fail(error.what());
    }
}
