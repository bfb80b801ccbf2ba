// libFuzzer: any bytes as a .vdb, read as the tools read it. Only InputError may come out of reading, and a level set
// that is read must be one that can be traced, leaf by leaf or whole, to the same finite hits.
//
// How to build and run it stands in scripts/fuzz.sh. OpenVDB itself is not instrumented, but for what its headers hold.
#include "base/error.h"
#include "fuzz/memory_file.h"
#include "fuzz/require.h"
#include "march/attribute/attribute_grid.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"

#include <openvdb/openvdb.h>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace {

namespace march = stratum::march;
namespace trace = stratum::trace;

constexpr std::size_t kRays = 27;

std::array<trace::Hit, kRays> hitsOf(const trace::Intersector& surface) {
    const trace::Box box = surface.bounds();
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    const glm::dvec3 size = box.max - box.min;
    std::array<trace::Ray, kRays> rays;
    for (std::size_t n = 0; n < kRays; ++n) {
        const glm::dvec3 way(static_cast<double>(n % 3) - 1.1, static_cast<double>(n / 3 % 3) - 0.9,
                             static_cast<double>(n / 9) - 0.7);
        rays[n].direction = glm::normalize(way);
        rays[n].origin = middle + 0.1 * static_cast<double>(n) / kRays * size - glm::length(size) * rays[n].direction;
    }
    std::array<trace::Hit, kRays> hits;
    surface.makeTracer()->intersectStream(rays, hits);
    for (const trace::Hit& hit : hits) {
        require(!std::isnan(hit.t));
        if (std::isfinite(hit.t)) require(std::isfinite(glm::length(hit.normal)) && std::isfinite(hit.position.z));
    }
    return hits;
}

void read(const std::filesystem::path& path) {
    const auto file = march::openLevelSet(path);
    if (file) {
        (void)file->activeBox();
        (void)file->activeVoxelCount();
    }
    try {
        const auto attribute =
            march::readAttributeGrid(path, "layer", file ? file->head() : *march::readLevelSet(path));
        (void)march::summarize(*attribute);
    } catch (const stratum::InputError&) {
    }
    const auto grid = march::readLevelSet(path);
    const auto hits = hitsOf(*march::makeBrickIntersector(*grid, march::BrickValues::Float32));
    if (!file) return;
    require(file->leafCount() == grid->tree().leafCount() && file->activeBox() == grid->evalActiveVoxelBoundingBox());
    const auto same = hitsOf(*march::makeBrickIntersector(file, march::BrickValues::Float32));
    for (std::size_t n = 0; n < kRays; ++n) require(hits[n].t == same[n].t);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
    openvdb::initialize();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const stratum::test::MemoryFile file({reinterpret_cast<const char*>(data), size});
    try {
        read(file.path());
    } catch (const stratum::InputError&) {
    }
    return 0;
}
