// Loops over many points or rays.
#pragma once

#include "python/long_call.h"

#include "base/parallel_for.h"
#include "base/progress_meter.h"

#include <pybind11/pybind11.h>

#include <cstddef>

namespace stratum::python {

/// Calls body(first, last) for parts of [0, count), in parallel and without the GIL. Many points are a long call; of a
/// few, the calling thread does it all.
template <typename Body>
void forPoints(std::size_t count, const pybind11::object& progress, const Body& body) {
    constexpr std::size_t kFew = 4096;
    if (count <= kFew && progress.is_none()) {
        const pybind11::gil_scoped_release release;
        body(std::size_t{0}, count);
        return;
    }
    runLong(progress, [&](const Report& report) {
        ProgressMeter meter(count, report);
        parallelFor(count, kFew, [&](std::size_t first, std::size_t last) {
            body(first, last);
            meter.advance(last - first);
        });
    });
}

}  // namespace stratum::python
