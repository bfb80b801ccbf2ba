// Work that several threads may want, and that one of them does.
#pragma once

#include <atomic>
#include <cstdint>

namespace stratum::voxelize {

/// Work that is done once, by the thread that comes first.
class Once {
public:
    /// Does it unless it is done. False if another thread is at it.
    template <typename Work>
    bool doUnlessAtWork(const Work& work) {
        State expected = State::to_do;
        if (state_.compare_exchange_strong(expected, State::at_work)) {
            try {
                work();
            } catch (...) {
                leave(State::to_do);
                throw;
            }
            leave(State::done);
            return true;
        }
        return expected == State::done;
    }
    bool isDone() const { return state_.load() == State::done; }
    /// Does it, or waits until it is done.
    template <typename Work>
    void doOrWait(const Work& work) {
        while (!doUnlessAtWork(work)) state_.wait(State::at_work);
    }

private:
    enum class State : std::uint8_t { to_do, at_work, done };
    void leave(State state) {
        state_.store(state);
        state_.notify_all();
    }
    std::atomic<State> state_ = State::to_do;
};

}  // namespace stratum::voxelize
