// libFuzzer: any bytes as a map of light, Radiance or OpenEXR. Only InputError may come out of reading it, and what is
// read must give light: finite radiance and densities in all directions.
//
// How to build and run it stands in scripts/fuzz.sh.
#include "base/error.h"
#include "fuzz/memory_file.h"
#include "fuzz/require.h"
#include "shade/environment/light_map.h"
#include "shade/environment/map_environment.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace {

void check(const stratum::shade::LightMap& map) {
    require(map.width == 2 * map.height);
    require(map.texels.size() == static_cast<std::size_t>(map.width) * static_cast<std::size_t>(map.height));
    constexpr std::size_t kFew = 512;  // tables of more texels find nothing, slowly
    if (map.texels.size() > kFew) return;
    const stratum::shade::MapEnvironment environment(map, 0.5, 1.0f);
    for (const glm::vec2 u : {glm::vec2(0.0f), glm::vec2(0.37f, 0.61f), glm::vec2(0.999f, 0.5f)}) {
        for (int strategy = 0; strategy < environment.strategies(); ++strategy) {
            const auto sample = environment.sample(strategy, u, {0.6f, 0.0f, 0.8f});
            require(std::isfinite(sample.pdf) && sample.pdf >= 0.0f);
            require(stratum::shade::isFinite(sample.radiance));
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const stratum::test::MemoryFile file({reinterpret_cast<const char*>(data), size});
    try {
        check(stratum::shade::readLightMap(file.path()));
    } catch (const stratum::InputError&) {
    }
    return 0;
}
