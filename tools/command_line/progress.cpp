#include "progress.h"

#include "command_line.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <utility>

namespace stratum::tools {
namespace {

using std::chrono::steady_clock;

constexpr int kUsualColumns = 80;

// Of the terminal, or usual ones where it does not say.
int columns() {
    winsize size{};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kUsualColumns;
}

// One line in place of the one before. It is cut so that it does not fill the last column: what wraps is never cleared.
void showLine(std::string_view text) {
    const auto room = static_cast<std::size_t>(std::max(1, columns() - 1));
    std::size_t end = 0;
    for (std::size_t shown = 0; end < text.size(); ++end) {
        const bool begins = (static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U;  // of a character in UTF-8
        if (begins && ++shown > room) break;
    }
    tellError(fmt::format("\r\033[K{}", text.substr(0, end)));
}

void clearLine() { showLine({}); }

}  // namespace

bool showsProgress(bool quiet) { return !quiet && ::isatty(STDERR_FILENO) != 0; }

ProgressBar::ProgressBar(std::string label, bool quiet)
    : label_(std::move(label)), visible_(showsProgress(quiet)), start_(steady_clock::now()), shown_(start_) {
    if (visible_) draw(0);
}

ProgressBar::~ProgressBar() {
    if (visible_) clearLine();
}

void ProgressBar::show(double fraction) {
    // Ten times a second is smooth.
    if (!visible_ || steady_clock::now() - shown_ < std::chrono::milliseconds(100)) return;
    shown_ = steady_clock::now();
    draw(fraction);
}

void ProgressBar::draw(double fraction) const {
    constexpr int kLongest = 32, kShortest = 3;
    const std::string label = fmt::format("{:<12} ", label_);
    std::string numbers = fmt::format(" {:3.0f} %", fraction * 100);
    if (fraction > 0.01) {
        const double seconds = secondsSince(start_);
        numbers += fmt::format("  {:.0f} s left", seconds / fraction - seconds);
    }
    // The bar takes what the words leave, and the same for up to four digits of seconds, so that it does not jump.
    const int words =
        static_cast<int>(label.size() + std::max(numbers.size(), std::string(" 100 %  1234 s left").size()));
    const int width = std::clamp(columns() - 1 - words, 0, kLongest);
    const int filled = std::clamp(static_cast<int>(fraction * width), 0, width);
    std::string bar;
    for (int i = 0; i < width && width >= kShortest; ++i) bar += i < filled ? "━" : "─";
    showLine(label + bar + numbers);
}

std::function<void(double)> ProgressBar::callback() {
    if (!visible_) return {};
    return [this](double fraction) { show(fraction); };
}

ProgressNote::ProgressNote(std::string label, bool quiet) : label_(std::move(label)) {
    if (showsProgress(quiet)) {
        showLine(label_);
        clock_ = std::thread([this] { run(steady_clock::now()); });
    }
}

ProgressNote::~ProgressNote() {
    if (!clock_.joinable()) return;
    {
        const std::scoped_lock lock(mutex_);
        done_ = true;
    }
    over_.notify_one();
    clock_.join();
    clearLine();
}

void ProgressNote::run(steady_clock::time_point start) {
    std::unique_lock lock(mutex_);
    while (!over_.wait_for(lock, std::chrono::seconds(1), [this] { return done_; })) {
        showLine(fmt::format("{:<12} {:.0f} s", label_, secondsSince(start)));
    }
}

}  // namespace stratum::tools
