#include "view/asked/message.h"

#include "base/error.h"
#include "base/options/json_section.h"

#include <nlohmann/json.hpp>

#include <string>

namespace stratum::view {
namespace {

FindMessage readFind(JsonSection& section) {
    constexpr std::size_t kMostText = 200;
    FindMessage find;
    section.read("text", find.text);
    if (find.text.size() > kMostText) section.fail("text", "a short text");
    section.readInteger("line", find.line);
    section.read("back", find.back);
    if (section.find("seconds") != nullptr) {
        section.read("seconds", find.seconds.emplace());
        if (!(*find.seconds >= 0.0 && *find.seconds < 1e9)) section.fail("seconds", "a time of the print");
    }
    if (find.text.empty() && find.line == 0 && !find.seconds) section.fail("text", "a text, a line or seconds");
    return find;
}

}  // namespace

Message parseMessage(std::string_view text) {
    static const std::string name = "the message";
    using Json = nlohmann::json;
    const Json json = Json::parse(text, nullptr, false);
    if (json.is_discarded()) throw InputError("the message is no JSON");
    JsonSection section(json, "", name);
    std::string type;
    section.read("type", type);
    std::uint64_t number = 0;
    section.readInteger("number", number);
    const auto state = [&] {
        const Json* view = section.find("state");
        if (view == nullptr) section.fail("state", "a view");
        return parseViewState(*view);
    };
    Message message;
    if (type == "show") {
        ShowMessage show{number, false, false, state()};
        section.read("moving", show.moving);
        section.read("own", show.own);
        message = std::move(show);
    } else if (type == "inspect") {
        InspectMessage inspect{number, 0.0, 0.0};
        section.read("x", inspect.x);
        section.read("y", inspect.y);
        if (!(inspect.x >= 0.0 && inspect.x <= 1.0 && inspect.y >= 0.0 && inspect.y <= 1.0))
            section.fail("x", "a place from 0 to 1, as y");
        message = inspect;
    } else if (type == "save") {
        message = SaveMessage{number, state()};
    } else if (type == "cancel") {
        message = CancelMessage{};
    } else if (type == "shown") {
        message = ShownMessage{};
    } else if (type == "beads") {
        message = BeadsMessage{};
    } else if (type == "moves") {
        message = MovesMessage{};
    } else if (type == "layers") {
        message = LayersMessage{};
    } else if (type == "program") {
        ProgramMessage program;
        if (section.find("bead") == nullptr) section.fail("bead", "the number of a bead");
        section.readInteger("bead", program.bead);
        message = program;
    } else if (type == "find") {
        message = readFind(section);
    } else if (type == "open") {
        OpenMessage open;
        std::uint32_t file = 0;
        section.readInteger("file", file);
        open.file = file;
        message = open;
    } else {
        section.fail("type", "show, inspect, save, cancel, shown, beads, moves, layers, program, find or open");
    }
    section.finish();
    return message;
}

}  // namespace stratum::view
