// What bench/march compares: something that finds the nearest hit of many rays, or whether there is one.
#pragma once

#include "trace/intersector.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace stratum::bench {

/// Rays that were prepared in the peer's own layout, so that only tracing is timed. One per set of rays.
class Prepared {
public:
    virtual ~Prepared() = default;
    /// Traces rays [first, last), a multiple of 16 from each other but at the end. Thread-safe for disjoint parts.
    /// t[i] is the distance of ray i, or infinite.
    virtual void nearest(std::size_t first, std::size_t last, double* t) = 0;
    virtual void any(std::size_t first, std::size_t last, std::uint8_t* blocked) = 0;
};

struct Peer {
    virtual ~Peer() = default;
    /// Keeps a reference to `rays`. `coherent`: neighbours run side by side.
    virtual std::unique_ptr<Prepared> prepare(std::span<const trace::Ray> rays, bool coherent) = 0;
    std::string name;
    double build_seconds = 0;
    double bytes = 0;  ///< besides what it was built from
};

/// An intersector of src/march; `streams` by its stream forms, else ray by ray.
std::unique_ptr<Peer> marchPeer(std::string name, std::shared_ptr<const trace::Intersector> intersector, bool streams,
                                double build_seconds);

}  // namespace stratum::bench
