// libFuzzer: any text as the key frames of a camera. Only InputError may come out of reading it, and a camera that
// follows what is read stays finite, and between its keys.
//
// How to build and run it stands in scripts/fuzz.sh.
#include "animate/camera_path.h"
#include "base/error.h"
#include "fuzz/memory_file.h"
#include "fuzz/require.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace {

void check(const std::vector<stratum::animate::CameraKey>& keys) {
    require(keys.size() >= 2 && stratum::animate::durationOf(keys) > 0);
    const stratum::animate::CameraPath path(keys, {10.0, 20.0, 5.0}, 30.0);
    const auto [least, most] =
        std::minmax_element(keys.begin(), keys.end(), [](const auto& a, const auto& b) { return a.eye.z < b.eye.z; });
    for (const double share : {0.0, 1e-9, 0.25, 0.5, 0.77, 1.0}) {
        stratum::shade::CameraOptions options;
        path.place(share, options);
        require(options.eye.has_value());
        for (int axis = 0; axis < 3; ++axis) require(std::isfinite((*options.eye)[axis]));
        const double rounding = 1e-12 * std::max(std::abs(least->eye.z), std::abs(most->eye.z));
        require(options.eye->z >= least->eye.z - rounding && options.eye->z <= most->eye.z + rounding);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const stratum::test::MemoryFile file(std::string_view(reinterpret_cast<const char*>(data), size));
    try {
        check(stratum::animate::readCameraKeys(file.path()));
    } catch (const stratum::InputError&) {
    }
    return 0;
}
