// libFuzzer: any text as a scene. Only InputError and UsageError may come out of reading it, and what is read must make
// shapes without a NaN, cameras, lamps and placements.
//
// How to build and run it stands in scripts/fuzz.sh. Materials and environments that name files are left out: they have
// a target of their own.
#include "assemble/scene_file.h"
#include "base/error.h"
#include "fuzz/memory_file.h"
#include "fuzz/require.h"
#include "shade/camera/camera.h"
#include "shade/light/light.h"
#include "trace/sdf.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace {

bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void check(const stratum::trace::Sdf& shape) {
    const stratum::trace::Box box = shape.bounds();
    for (int axis = 0; axis < 3; ++axis) require(!std::isnan(box.min[axis]) && !std::isnan(box.max[axis]));
    for (const glm::dvec3& p : {glm::dvec3(0.0), glm::dvec3(1.0, -2.0, 0.25), glm::dvec3(-300.0, 40.0, 1e4)})
        require(!std::isnan(shape.distance(p)));
}

void check(const stratum::assemble::SceneFile& file) {
    require(!file.print.empty() || !file.objects.empty());
    for (const stratum::assemble::ObjectOptions& object : file.objects) {
        require(object.vdb.empty() == (object.sdf != nullptr));
        if (object.sdf) check(*object.sdf);
    }
    for (const std::string& light : file.scene.lights)
        if (!stratum::shade::parseAmbient(light)) (void)stratum::shade::parseLight(light);
    const stratum::trace::Box box{glm::dvec3(-1.0), glm::dvec3(1.0, 2.0, 3.0)};
    const auto camera = stratum::shade::Camera::make(file.scene.camera, box, 64, 48);
    require(isFinite(camera.ray({3.0, 5.0}).direction));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    (void)stratum::assemble::isSceneFile(text);
    const stratum::test::MemoryFile file(text);
    try {
        check(stratum::assemble::readSceneFile(file.path()));
    } catch (const stratum::InputError&) {
    } catch (const stratum::UsageError&) {
    }
    return 0;
}
