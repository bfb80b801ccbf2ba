#include "python/threads.h"

#include "python/options/signature.h"

#include <tbb/global_control.h>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace stratum::python {

namespace py = pybind11;

namespace {

using Limit = tbb::global_control;

// With the GIL.
std::unique_ptr<Limit>& limit() {
    static std::unique_ptr<Limit> limit;
    return limit;
}

void setThreads(const py::object& count) {
    if (count.is_none()) {
        limit().reset();
        return;
    }
    constexpr std::int64_t kMost = 1 << 16;
    py::kwargs given;
    given["count"] = count;
    const auto threads = Keywords("set_threads", given).integer("count", 1, kMost);  // None: all processors
    limit() = std::make_unique<Limit>(Limit::max_allowed_parallelism, static_cast<std::size_t>(threads.value()));
}

}  // namespace

void bindThreads(py::module_& module) {
    module.def("set_threads", &setThreads,
               documented("set_threads(count)",
                          "How many threads calls of this process may use; None is all processors. Results don't "
                          "depend on it.")
                   .c_str(),
               py::arg("count"));
    module.def(
        "threads", [] { return Limit::active_value(Limit::max_allowed_parallelism); },
        documented("threads()", "How many threads calls of this process may use, see set_threads().").c_str());
}

}  // namespace stratum::python
