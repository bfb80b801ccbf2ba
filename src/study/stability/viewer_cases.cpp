// What a page may send to the viewer: hostile messages, and views at the edge of what is allowed.
#include "base/error.h"
#include "shade/camera/camera.h"
#include "study/stability/stability_case.h"
#include "view/asked/message.h"
#include "view/asked/picture_plan.h"

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace stratum::study {
namespace {

// 0 if it is refused with a message.
double accepted(const std::string& text) {
    try {
        (void)view::parseMessage(text);
    } catch (const InputError&) {
        return 0;
    }
    return 1;
}

std::string show(const std::string& state) { return fmt::format(R"({{"type":"show","state":{}}})", state); }

std::string repeated(const std::string& text, int count) {
    std::string all;
    for (int n = 0; n < count; ++n) all += text;
    return all;
}

// What is off about a view that is allowed: it changes when it is written and read again, or has rays that are no
// numbers.
double offOf(const std::string& text) {
    const view::Message message = view::parseMessage(text);
    const view::ViewState& state = std::get<view::ShowMessage>(message).state;
    if (!(view::parseViewState(view::toJson(state)) == state)) return 1;
    view::GivenInput given;
    given.path = "part.gcode";
    given.objects.emplace_back();
    const view::PicturePlan plan = view::planPicture(given, state);
    const trace::Box box{glm::dvec3(-1.0), glm::dvec3(1.0, 2.0, 3.0)};
    const auto camera = shade::Camera::make(plan.options.scene.camera, box, state.width, state.height);
    const auto ray = camera.ray({0.5, 0.5});
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(ray.origin[axis]) || !std::isfinite(ray.direction[axis])) return 1;
    return 0;
}

}  // namespace

std::vector<StabilityCase> viewerCases() {
    const std::vector<std::pair<const char*, std::string>> hostile{
        {"no message", ""},
        {"a million open brackets", repeated("[", 1000000)},
        {"100000 objects in one another", repeated("{\"a\":", 100000)},
        {"bytes that are no text", "\xff\xfe\x80"},
        {"a zero in the text", std::string("{\"type\":\"shown\0\"}", 17)},
        {"an unknown kind", R"({"type":"quit"})"},
        {"a key too many", R"({"type":"shown","more":1})"},
        {"a place that is no number", R"({"type":"inspect","number":1,"x":NaN,"y":0})"},
        {"a place beside the picture", R"({"type":"inspect","number":1,"x":1e308,"y":0})"},
        {"a picture of 10^18 pixels", show(R"({"size":[1000000000,1000000000]})")},
        {"a picture of no pixels", show(R"({"size":[0,0]})")},
        {"a camera without end", show(R"({"camera":{"eye":[1e300,0,0],"look_at":[0,0,0]}})")},
        {"a material in a file", show(R"({"material":"/etc/passwd"})")},
        {"a light in a file", show(R"({"light":"../../etc/passwd"})")},
        {"a text of a megabyte", show("{\"material\":\"" + std::string(1000000, 'a') + "\"}")},
        {"more of the print than all", show(R"({"printed":1e9})")},
        {"layers upside down", show(R"({"layers":[9,2]})")},
        {"half a layer", show(R"({"layers":[1.5,2]})")},
        {"a cut along nothing", show(R"({"clip":[0,0,0,1]})")}};
    std::vector<StabilityCase> cases;
    cases.reserve(hostile.size());
    for (const auto& [name, text] : hostile)
        cases.push_back({"viewer", name, "accepted (1) or refused with a message (0)", 0,
                         "what can't be shown is refused, with nothing done",
                         [text = text] { return accepted(text); }});
    const std::vector<std::pair<const char*, std::string>> extreme{
        {"straight from above", show(R"({"camera":{"eye":[0,0,1000],"look_at":[0,0,0],"up":[0,1,0]}})")},
        {"10 km away", show(R"({"camera":{"eye":[1e7,0,0],"look_at":[0,0,0]}})")},
        {"a micrometre away", show(R"({"camera":{"eye":[0,0,1e-3],"look_at":[0,0,0],"up":[0,1,0]}})")},
        {"inside of the part", show(R"({"camera":{"eye":[0,0,0],"look_at":[1,0,0]}})")},
        {"layer one alone", show(R"({"layers":[1,1]})")},
        {"a millionth of a per cent", show(R"({"printed":1e-6})")}};
    for (const auto& [name, text] : extreme)
        cases.push_back({"viewer", name, "changes or rays that are no numbers (1) or none (0)", 0,
                         "a view that is allowed makes a picture", [text = text] { return offOf(text); }});
    return cases;
}

}  // namespace stratum::study
