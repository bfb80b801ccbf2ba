#include "progress.h"

#include "command_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace stratum::tools {
namespace {

using std::chrono::steady_clock;

void clearLine() {
    tellError("\r\033[K");
    std::fflush(stderr);
}

double secondsSince(steady_clock::time_point start) {
    return std::chrono::duration<double>(steady_clock::now() - start).count();
}

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
    constexpr int kWidth = 32;
    const int filled = std::clamp(static_cast<int>(fraction * kWidth), 0, kWidth);
    std::string bar;
    for (int i = 0; i < kWidth; ++i) bar += i < filled ? "━" : "─";
    tellError(fmt::format("\r\033[K{:<12} {} {:3.0f} %", label_, bar, fraction * 100));
    if (fraction > 0.01) {
        const double seconds = secondsSince(start_);
        tellError(fmt::format("  {:.0f} s left", seconds / fraction - seconds));
    }
    std::fflush(stderr);
}

std::function<void(double)> ProgressBar::callback() {
    if (!visible_) return {};
    return [this](double fraction) { show(fraction); };
}

ProgressNote::ProgressNote(std::string label, bool quiet) : label_(std::move(label)) {
    if (showsProgress(quiet)) {
        tellError(fmt::format("\r\033[K{}", label_));
        std::fflush(stderr);
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
        tellError(fmt::format("\r\033[K{:<12} {:.0f} s", label_, secondsSince(start)));
        std::fflush(stderr);
    }
}

}  // namespace stratum::tools
