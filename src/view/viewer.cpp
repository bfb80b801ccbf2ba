#include "view/viewer.h"

#include "base/error.h"
#include "base/json_text.h"
#include "base/stopwatch.h"
#include "view/asked/message.h"
#include "view/loading_events.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <utility>

namespace stratum::view {
namespace {

using Json = nlohmann::json;

// A picture with its head: the head's length as four bytes, the least first, the head, the file.
std::vector<std::uint8_t> packed(const Json& head, const std::vector<std::uint8_t>& file) {
    const std::string text = jsonText(head);
    std::vector<std::uint8_t> bytes;
    bytes.reserve(4 + text.size() + file.size());
    for (unsigned shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(text.size() >> shift));
    bytes.insert(bytes.end(), text.begin(), text.end());
    bytes.insert(bytes.end(), file.begin(), file.end());
    return bytes;
}

Output outputTo(const std::shared_ptr<serve::Client>& client) {
    // The page may be gone long before its last picture is made.
    const std::weak_ptr<serve::Client> weak = client;
    return {[weak](const Json& message) {
                if (const auto to = weak.lock()) to->sendText(jsonText(message));
            },
            [weak](const Json& head, const std::vector<std::uint8_t>& file) {
                if (const auto to = weak.lock()) to->sendBytes(packed(head, file));
            }};
}

}  // namespace

Viewer::Viewer(std::vector<GivenInput> inputs, std::function<void(const std::string&)> say) : say_(std::move(say)) {
    for (GivenInput& given : inputs) {
        inputs_.push_back(std::make_unique<Input>(std::move(given)));
        watch_.add(inputs_.back()->files);
    }
    // The first is read before a page asks for it.
    loop_.post([this] { load(*inputs_.front()); });
}

Viewer::~Viewer() = default;

void Viewer::load(Input& input) {
    Stopwatch watch;
    try {
        input.document.requireFiles();
        input.document.update();
        {
            const std::lock_guard lock(input.mutex);
            input.files = input.document.files();
        }
        watch_.add(input.document.files());
        input.document.requireFiles();
        const PicturePlan plan = planPicture(input.document.given(), ViewState());
        input.scene.makeObjects(plan, loadingEvents([&input](const Json& message) {
                                    const std::lock_guard lock(input.mutex);
                                    for (const Output& page : input.waiting) page.text(message);
                                }));
        input.failure.clear();
        say_(fmt::format("{}: ready after {:.2f} s", input.path, watch.lap()));
    } catch (const std::exception& error) {
        input.failure = error.what();
        say_(input.failure);
    }
}

void Viewer::changed(const std::set<std::string>& paths) {
    if (paths.empty()) return;
    for (const auto& each : inputs_) {
        Input& input = *each;
        {
            const std::lock_guard lock(input.mutex);
            if (std::none_of(input.files.begin(), input.files.end(),
                             [&](const std::string& file) { return paths.contains(file); }))
                continue;
        }
        std::vector<std::shared_ptr<Viewport>> viewports;
        for (const auto& [client, page] : pages_)
            if (inputs_[page.file].get() == &input) viewports.push_back(page.viewport);
        loop_.post([this, &input, viewports] {
            input.document.forget();
            for (const auto& viewport : viewports) viewport->output().text({{"type", "loading"}, {"step", "reading"}});
            load(input);
            for (const auto& viewport : viewports) {
                if (!input.failure.empty()) {
                    viewport->fail(input.failure);
                    continue;
                }
                viewport->output().text({{"type", "facts"}, {"facts", input.document.facts()}});
                viewport->restart();
            }
        });
    }
}

void Viewer::open(const std::shared_ptr<serve::Client>& client, std::size_t file) {
    Page& page = pages_[client];
    if (page.viewport) loop_.remove(page.viewport);
    page = {nullptr, file};
    Input& input = *inputs_[file];
    page.viewport = std::make_shared<Viewport>(input.document, outputTo(client));
    client->sendText(jsonText(Json{{"type", "loading"}, {"step", "reading"}}));
    {
        const std::lock_guard lock(input.mutex);
        input.waiting.push_back(page.viewport->output());
    }
    loop_.post([this, &input, viewport = page.viewport] {
        if (input.scene.empty() && input.failure.empty()) load(input);
        {
            const std::lock_guard lock(input.mutex);
            input.waiting.clear();  // whose turn has not come yet is told nothing new any more
        }
        viewport->startWith(input.scene);
        if (!input.failure.empty()) viewport->output().text({{"type", "failed"}, {"text", input.failure}});
        viewport->output().text({{"type", "facts"}, {"facts", input.document.facts()}});
    });
    loop_.add(page.viewport);
}

void Viewer::opened(const std::shared_ptr<serve::Client>& client) {
    Json files = Json::array();
    for (const auto& input : inputs_) files.push_back(std::filesystem::path(input->path).filename().string());
    client->sendText(jsonText(Json{{"type", "hello"}, {"version", STRATUM_VERSION}, {"files", std::move(files)}}));
    open(client, 0);
}

void Viewer::received(const std::shared_ptr<serve::Client>& client, std::string_view text) {
    const auto page = pages_.find(client);
    if (page == pages_.end()) return;
    try {
        Message message = parseMessage(text);
        if (const auto* other = std::get_if<OpenMessage>(&message)) {
            if (other->file >= inputs_.size()) throw InputError("the message: file: there are fewer inputs");
            open(client, other->file);
            return;
        }
        page->second.viewport->ask(std::move(message));
        loop_.wake();
    } catch (const InputError& error) {
        client->sendText(jsonText(Json{{"type", "refused"}, {"text", error.what()}}));
    }
}

void Viewer::closed(const std::shared_ptr<serve::Client>& client) {
    const auto page = pages_.find(client);
    if (page == pages_.end()) return;
    loop_.remove(page->second.viewport);
    pages_.erase(page);
}

}  // namespace stratum::view
