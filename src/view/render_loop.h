// The thread that works for all pages: who moves comes first, and all have their turns.
#pragma once

#include "view/viewport.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace stratum::view {

class RenderLoop {
public:
    RenderLoop();
    /// Ends what goes on, and waits for it.
    ~RenderLoop();
    RenderLoop(const RenderLoop&) = delete;
    RenderLoop& operator=(const RenderLoop&) = delete;

    // From any thread.
    void add(std::shared_ptr<Viewport> viewport);
    void remove(const std::shared_ptr<Viewport>& viewport);
    /// Something was asked of a viewport.
    void wake();
    /// Runs on the loop's thread before the next piece of work; must not throw.
    void post(std::function<void()> task);

private:
    struct PutOff {};  // thrown where work is put off

    void run();
    std::shared_ptr<Viewport> next(bool urgent);
    void check(const Viewport& at_work);

    std::mutex mutex_;
    std::condition_variable changed_;
    std::vector<std::shared_ptr<Viewport>> viewports_;
    std::deque<std::function<void()>> tasks_;
    std::size_t turn_ = 0;
    bool stop_ = false, woken_ = false;
    std::thread thread_;  // the last one: it uses the others
};

}  // namespace stratum::view
