#include "study/report/run_log.h"

#include "base/text.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string_view>
#include <thread>

namespace stratum::study {
namespace {

// The value of a "key : value" line of a system file.
std::string valueIn(const char* file, std::string_view key) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.rfind(key, 0) != 0) continue;
        const std::size_t at = line.find_first_of(":=");
        if (at == std::string::npos) continue;
        return std::string(trim(std::string_view(line).substr(at + 1), " \t\""));
    }
    return {};
}

}  // namespace

std::string machineLine() {
    const std::string processor = valueIn("/proc/cpuinfo", "model name");
    const double memory = std::atof(valueIn("/proc/meminfo", "MemTotal").c_str()) * 1024e-9;
    const std::string system = valueIn("/etc/os-release", "PRETTY_NAME");
    return fmt::format("{}, {} threads, {:.0f} GB of memory, {}, compiler {}",
                       processor.empty() ? "unknown processor" : processor, std::thread::hardware_concurrency(), memory,
                       system.empty() ? "unknown system" : system, __VERSION__);
}

std::string shownCommand(std::span<const std::string> command) {
    std::string text;
    for (const std::string& word : command) {
        const bool folder = word.size() > 1 && word.back() == '/';
        const std::size_t slash = (folder ? word.substr(0, word.size() - 1) : word).rfind('/');
        if (!text.empty()) text += ' ';
        text += slash == std::string::npos ? word : word.substr(slash + 1);
    }
    return text;
}

const Row& RunLog::columns() {
    static const Row kColumns{"run", "date", "version", "machine", "command"};
    return kColumns;
}

RunLog::RunLog(const std::filesystem::path& folder, std::span<const std::string> command)
    : table_(folder / "runs.csv", columns(), 1), command_(shownCommand(command)) {}

const std::string& RunLog::number() {
    if (!number_.empty()) return number_;
    // All tables of one process are of one run.
    static const std::time_t kBegun = std::time(nullptr);
    Row row{"", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(kBegun)), STRATUM_VERSION, machineLine(), command_};
    for (const Row& known : table_.rows()) {
        row[0] = known[0];
        if (known == row) number_ = known[0];
    }
    if (number_.empty()) {
        number_ = std::to_string(table_.rows().size() + 1);
        row[0] = number_;
        table_.add(std::move(row));
    }
    return number_;
}

}  // namespace stratum::study
