// What a person at a terminal sees while a tool works: one line on stderr, gone when the step is over.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace stratum::tools {

/// Whether such lines are shown: stderr is a terminal, and the tool is not quiet.
bool showsProgress(bool quiet);

/// A line that fills while a step goes on whose end is known. There from its beginning, cleared at its end; nothing
/// else may write to the terminal meanwhile.
class ProgressBar {
public:
    ProgressBar(std::string label, bool quiet);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;
    /// Fraction done, 0..1. Calls must not overlap.
    void show(double fraction);
    /// Empty when nothing would be shown, so that the work reports nothing.
    std::function<void(double)> callback();

private:
    void draw(double fraction) const;

    std::string label_;
    bool visible_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point shown_;
};

/// A line for a step of which nobody knows how much is left: its name and the seconds it has taken so far.
class ProgressNote {
public:
    ProgressNote(std::string label, bool quiet);
    ~ProgressNote();
    ProgressNote(const ProgressNote&) = delete;
    ProgressNote& operator=(const ProgressNote&) = delete;

private:
    void run(std::chrono::steady_clock::time_point start);

    std::string label_;
    std::mutex mutex_;
    std::condition_variable over_;
    bool done_ = false;
    std::thread clock_;  // only if there is something to show
};

}  // namespace stratum::tools
