#include "march_peer.h"

#include <tbb/enumerable_thread_specific.h>

#include <limits>
#include <utility>
#include <vector>

namespace stratum::bench {
namespace {

struct Worker {
    std::unique_ptr<trace::Tracer> tracer;
    std::vector<trace::Hit> hits;
};

class MarchRays final : public Prepared {
public:
    MarchRays(const trace::Intersector& intersector, std::span<const trace::Ray> rays, bool streams)
        : rays_(rays), streams_(streams), workers_([&intersector] {
              return Worker{intersector.makeTracer(), {}};
          }) {}

    void nearest(std::size_t first, std::size_t last, double* t) override {
        Worker& worker = workers_.local();
        worker.hits.resize(last - first);
        if (streams_)
            worker.tracer->intersectStream(rays_.subspan(first, last - first), worker.hits);
        else
            for (std::size_t n = first; n != last; ++n)
                if (!worker.tracer->intersect(rays_[n], worker.hits[n - first]))
                    worker.hits[n - first].t = std::numeric_limits<double>::infinity();
        for (std::size_t n = first; n != last; ++n) t[n] = worker.hits[n - first].t;
    }
    void any(std::size_t first, std::size_t last, std::uint8_t* blocked) override {
        Worker& worker = workers_.local();
        if (streams_)
            worker.tracer->occludedStream(rays_.subspan(first, last - first), {blocked + first, last - first});
        else
            for (std::size_t n = first; n != last; ++n) blocked[n] = worker.tracer->occluded(rays_[n]) ? 1 : 0;
    }

private:
    std::span<const trace::Ray> rays_;
    bool streams_;
    tbb::enumerable_thread_specific<Worker> workers_;
};

class MarchPeer final : public Peer {
public:
    MarchPeer(std::shared_ptr<const trace::Intersector> intersector, bool streams)
        : intersector_(std::move(intersector)), streams_(streams) {}
    std::unique_ptr<Prepared> prepare(std::span<const trace::Ray> rays, bool) override {
        return std::make_unique<MarchRays>(*intersector_, rays, streams_);
    }

private:
    std::shared_ptr<const trace::Intersector> intersector_;
    bool streams_;
};

}  // namespace

std::unique_ptr<Peer> marchPeer(std::string name, std::shared_ptr<const trace::Intersector> intersector, bool streams,
                                double build_seconds) {
    const double bytes = static_cast<double>(intersector->bytes());
    auto peer = std::make_unique<MarchPeer>(std::move(intersector), streams);
    peer->name = std::move(name);
    peer->build_seconds = build_seconds;
    peer->bytes = bytes;
    return peer;
}

}  // namespace stratum::bench
