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

Viewer::Viewer(std::vector<GivenInput> inputs, Say say, Read read) : say_(std::move(say)), read_(std::move(read)) {
    for (GivenInput& given : inputs) add(std::move(given));
    // The first is read before a page asks for it.
    loop_.post([this] { load(*inputs_.front()); });
}

Viewer::~Viewer() = default;

void Viewer::add(GivenInput given) {
    inputs_.push_back(std::make_unique<Input>(std::move(given)));
    watch_.add(inputs_.back()->files);
}

Json Viewer::files() const {
    Json names = Json::array();
    for (const auto& input : inputs_) names.push_back(std::filesystem::path(input->path).filename().string());
    return names;
}

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
            const bool idle = viewports.empty() && input.scene.empty() && input.failure.empty();
            input.document.forget();
            if (idle) return;  // nobody has asked for it
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

bool Viewer::isLookedAt(std::size_t file) const {
    return std::any_of(pages_.begin(), pages_.end(), [&](const auto& each) { return each.second.file == file; });
}

// Of what no page looks at, the input that was left last stays ready: people go to and fro between two.
void Viewer::forgetOthers(std::size_t left) {
    for (std::size_t n = 0; n < inputs_.size(); ++n) {
        if (n == left || isLookedAt(n)) continue;
        loop_.post([&input = *inputs_[n]] {
            if (input.scene.empty()) return;
            input.scene.forget();
            input.document.forget();
        });
    }
}

void Viewer::open(const std::shared_ptr<serve::Client>& client, std::size_t file) {
    Page& page = pages_[client];
    if (page.viewport) {
        loop_.remove(page.viewport);
        const std::size_t left = std::exchange(page.file, file);
        if (left != file) forgetOthers(left);
    }
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
    client->sendText(jsonText(Json{{"type", "hello"},
                                   {"version", STRATUM_VERSION},
                                   {"files", files()},
                                   {"takes", read_ ? SentFiles::kMostBytes : 0}}));
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

std::filesystem::path Viewer::incoming(std::string_view name) {
    if (!read_) throw InputError("files are taken from pages of this machine alone; name them on the command line");
    return sent_.place(name);
}

std::string Viewer::arrived(const std::filesystem::path& path) {
    try {
        add(read_(path.string()));
    } catch (...) {
        SentFiles::remove(path);
        throw;
    }
    for (const auto& [client, page] : pages_) client->sendText(jsonText(Json{{"type", "files"}, {"files", files()}}));
    return std::to_string(inputs_.size() - 1);
}

}  // namespace stratum::view
