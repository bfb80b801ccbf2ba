#include "view/render_loop.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace stratum::view {

RenderLoop::RenderLoop() : thread_([this] { run(); }) {}

RenderLoop::~RenderLoop() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void RenderLoop::add(std::shared_ptr<Viewport> viewport) {
    {
        const std::lock_guard lock(mutex_);
        viewports_.push_back(std::move(viewport));
    }
    wake();
}

void RenderLoop::remove(const std::shared_ptr<Viewport>& viewport) {
    const std::lock_guard lock(mutex_);
    std::erase(viewports_, viewport);
}

void RenderLoop::wake() {
    {
        const std::lock_guard lock(mutex_);
        woken_ = true;
    }
    changed_.notify_all();
}

void RenderLoop::post(std::function<void()> task) {
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
}

// The one whose turn it is; `mutex_` is held.
std::shared_ptr<Viewport> RenderLoop::next(bool urgent) {
    for (std::size_t n = 0; n < viewports_.size(); ++n) {
        const std::size_t index = (turn_ + n) % viewports_.size();
        if (!viewports_[index]->hasWork(urgent)) continue;
        turn_ = index + 1;
        return viewports_[index];
    }
    return nullptr;
}

void RenderLoop::check(const Viewport& at_work) {
    const std::lock_guard lock(mutex_);
    const auto waits = [&](const std::shared_ptr<Viewport>& viewport) {
        return viewport.get() != &at_work && viewport->hasWork(true);
    };
    if (stop_ || !tasks_.empty() || at_work.overtaken() || std::any_of(viewports_.begin(), viewports_.end(), waits))
        throw PutOff{};
}

void RenderLoop::run() {
    std::unique_lock lock(mutex_);
    while (!stop_) {
        if (!tasks_.empty()) {
            const std::function<void()> task = std::move(tasks_.front());
            tasks_.pop_front();
            lock.unlock();
            task();
            lock.lock();
            continue;
        }
        woken_ = false;
        std::shared_ptr<Viewport> viewport = next(true);
        if (!viewport) viewport = next(false);
        if (!viewport) {
            std::optional<Viewport::Clock::time_point> at;
            for (const auto& each : viewports_)
                if (const auto its = each->worksAt(); its && (!at || *its < *at)) at = its;
            const auto changed = [this] { return stop_ || woken_ || !tasks_.empty(); };
            if (at)
                changed_.wait_until(lock, *at, changed);
            else
                changed_.wait(lock, changed);
            continue;
        }
        lock.unlock();
        try {
            viewport->step([&] { check(*viewport); });
        } catch (const PutOff&) {
            // Its turn comes again.
        }
        viewport.reset();
        lock.lock();
    }
}

}  // namespace stratum::view
