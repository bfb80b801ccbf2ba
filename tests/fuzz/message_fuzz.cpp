// libFuzzer: any bytes as a message of a page to the viewer. Only InputError may come out of reading them; what is read
// makes options without a NaN that name no file, and is the same when it is written and read again.
//
// How to build and run it stands in scripts/fuzz.sh.
#include "base/error.h"
#include "fuzz/require.h"
#include "shade/environment/environment.h"
#include "shade/finish/named_brdf.h"
#include "shade/palette/filament_color.h"
#include "view/asked/message.h"
#include "view/asked/picture_plan.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <variant>

namespace {

using namespace stratum;

void check(const view::ViewState& state) {
    require(view::parseViewState(view::toJson(state)) == state);
    require(state.width > 0 && state.height > 0 && std::isfinite(state.fov));
    require(state.material.empty() || shade::isBrdfPreset(state.material) || shade::parseNamedColor(state.material));
    require(state.light.empty() || shade::isEnvironmentPreset(state.light));
    view::GivenInput given;
    given.path = "part.gcode";
    given.objects.emplace_back();
    try {
        const view::PicturePlan plan = view::planPicture(given, state);
        require(!view::shellLine(plan.words).empty());
        const trace::Box box{glm::dvec3(-1.0), glm::dvec3(1.0, 2.0, 3.0)};
        const auto camera = shade::Camera::make(plan.options.scene.camera, box, state.width, state.height);
        require(std::isfinite(camera.ray({3.0, 5.0}).direction.x));
    } catch (const UsageError&) {
        // e.g. a camera that stands where it looks
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const view::Message message = view::parseMessage({reinterpret_cast<const char*>(data), size});
        if (const auto* show = std::get_if<view::ShowMessage>(&message)) check(show->state);
        if (const auto* save = std::get_if<view::SaveMessage>(&message)) check(save->state);
    } catch (const InputError&) {
    }
    return 0;
}
