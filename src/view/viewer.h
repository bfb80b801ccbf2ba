// The viewer: inputs on one side, pages on the other.
#pragma once

#include "serve/server.h"
#include "view/file_watch.h"
#include "view/input/document.h"
#include "view/input/view_scene.h"
#include "view/render_loop.h"
#include "view/sent_files.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::view {

/// The files of the page, as they were built in.
std::vector<serve::PageFile> pageFiles();

/// Handles what pages send, on the server's thread; pictures are made on the loop's thread. Every page has its own
/// view; what is read of an input is shared, and forgotten when other inputs are looked at.
class Viewer final : public serve::Handler {
public:
    using Say = std::function<void(const std::string&)>;
    /// Throws InputError.
    using Read = std::function<GivenInput(const std::string& path)>;

    /// @param say   tells the terminal of reloads and of inputs that fail; called on any thread, one call at a time
    /// @param read  makes an input of a file that a page sends; none: pages send no files
    Viewer(std::vector<GivenInput> inputs, Say say, Read read = {});
    ~Viewer() override;
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    /// Readable when files of the inputs may have changed: then filesChanged() is to be called. -1: the system tells
    /// nobody of changes.
    int descriptor() const { return watch_.descriptor(); }
    /// Reads those anew that have changed, and shows them where they are looked at.
    void filesChanged() { changed(watch_.changed()); }
    /// These files have changed.
    void changed(const std::set<std::string>& paths);

    void opened(const std::shared_ptr<serve::Client>& client) override;
    void received(const std::shared_ptr<serve::Client>& client, std::string_view text) override;
    void closed(const std::shared_ptr<serve::Client>& client) override;
    std::filesystem::path incoming(std::string_view name) override;
    std::string arrived(const std::filesystem::path& path) override;

private:
    /// An input and what is ready of it; of the loop's thread.
    struct Input {
        explicit Input(GivenInput given)
            : path(given.path), document(std::move(given)), scene(document), files(document.files()) {}
        const std::string path;
        Document document;
        ViewScene scene;  // of the input as it was given
        std::string failure;
        std::mutex mutex;                // of the next ones
        std::vector<Output> waiting;     // pages that were opened before it is ready
        std::vector<std::string> files;  // that it depends on
    };
    struct Page {
        std::shared_ptr<Viewport> viewport;
        std::size_t file = 0;
    };
    void add(GivenInput given);
    nlohmann::json files() const;
    void load(Input& input);
    void open(const std::shared_ptr<serve::Client>& client, std::size_t file);
    bool isLookedAt(std::size_t file) const;
    void forgetOthers(std::size_t left);

    const Say say_;
    const Read read_;
    FileWatch watch_;
    SentFiles sent_;
    std::vector<std::unique_ptr<Input>> inputs_;
    std::map<std::shared_ptr<serve::Client>, Page> pages_;  // of the server's thread
    RenderLoop loop_;                                       // the last one: it uses the others
};

}  // namespace stratum::view
