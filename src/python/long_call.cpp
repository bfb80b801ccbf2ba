#include "python/long_call.h"

#include "base/parallel_for.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <thread>

namespace stratum::python {

namespace py = pybind11;

namespace {

constexpr auto kPatience = std::chrono::milliseconds(50);

// What the two threads tell each other.
struct Shared {
    std::mutex mutex;
    std::condition_variable over;
    bool done = false;
    std::stop_source stop;
    std::atomic<double> fraction{-1};
};

class Waiter {
public:
    Waiter(const py::object& progress, Shared& shared) : progress_(progress), shared_(shared) {}

    void wait() {
        while (!finished())
            if (!failure_) look();
    }
    void rethrow() const {
        if (failure_) std::rethrow_exception(failure_);
    }
    /// The last fraction is told even if the work was quick.
    void tellEnd() {
        if (!failure_) tell();
    }

private:
    bool finished() {
        const py::gil_scoped_release release;
        std::unique_lock lock(shared_.mutex);
        return shared_.over.wait_for(lock, kPatience, [this] { return shared_.done; });
    }

    void look() {
        try {
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            tell();
        } catch (...) {
            failure_ = std::current_exception();
            shared_.stop.request_stop();
        }
    }

    void tell() {
        const double fraction = shared_.fraction;
        if (progress_.is_none() || fraction < 0 || fraction == told_) return;
        told_ = fraction;
        progress_(fraction);
    }

    const py::object& progress_;
    Shared& shared_;
    double told_ = -1;
    std::exception_ptr failure_;
};

}  // namespace

void runLong(const py::object& progress, const std::function<void(const Report&)>& work) {
    if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
        throw py::type_error("progress: expected a function of the fraction done, 0..1, or None");
    Shared shared;
    std::exception_ptr failure;
    const Report report = [&shared](double fraction) {
        shared.fraction = fraction;
        if (shared.stop.stop_requested()) throw Stopped();
    };
    std::thread worker([&, token = shared.stop.get_token()] {
        const StopScope scope(&token);
        try {
            work(report);
        } catch (const Stopped&) {
        } catch (...) {
            failure = std::current_exception();
        }
        const std::scoped_lock lock(shared.mutex);
        shared.done = true;
        shared.over.notify_one();
    });
    Waiter waiter(progress, shared);
    waiter.wait();
    worker.join();
    waiter.rethrow();
    if (failure) std::rethrow_exception(failure);
    waiter.tellEnd();
}

}  // namespace stratum::python
