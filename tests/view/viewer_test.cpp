#include "view/viewer.h"

#include "base/error.h"
#include "given_tile.h"
#include "scratch_folder.h"
#include "shown.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace stratum::view {
namespace {

/// A page on the other side of a web socket.
class Page final : public serve::Client {
public:
    void sendText(std::string text) override { shown.note(nlohmann::json::parse(text)); }
    void sendBytes(std::vector<std::uint8_t> bytes) override {
        std::size_t size = 0;
        for (std::size_t n = 0; n < 4; ++n) size |= std::size_t{bytes[n]} << (8 * n);
        shown.note(nlohmann::json::parse(bytes.begin() + 4, bytes.begin() + 4 + static_cast<std::ptrdiff_t>(size)));
    }
    void close(const std::string&) override {}
    test::Shown shown;
};

std::string showText(std::uint64_t number) {
    const nlohmann::json message{{"type", "show"}, {"number", number}, {"state", toJson(test::smallState())}};
    return message.dump();
}

GivenInput inputAt(const std::string& path) {
    GivenInput given = test::givenTile(0.2);
    given.path = path;
    given.objects.front().vdb = path;
    return given;
}

TEST(Viewer, AnswersEveryPage) {
    Viewer viewer({test::givenTile(0.2)}, [](const std::string&) {});
    std::vector<std::shared_ptr<Page>> pages;
    for (int n = 0; n < 3; ++n) {
        pages.push_back(std::make_shared<Page>());
        viewer.opened(pages.back());
        viewer.received(pages.back(), showText(1));
    }
    for (const auto& page : pages) {
        EXPECT_EQ(page->shown.waitFor("hello")["files"][0], "tile.gcode");
        EXPECT_FALSE(page->shown.waitFor("facts").is_null());
        EXPECT_FALSE(page->shown.waitFor("picture", 1, "moving").is_null());
        viewer.received(page, R"({"type":"shown"})");
        EXPECT_FALSE(page->shown.waitFor("picture", 1, "final").is_null());
    }
    for (const auto& page : pages) viewer.closed(page);
}

TEST(Viewer, RefusesWhatItDoesNotUnderstand) {
    Viewer viewer({test::givenTile(0.2)}, [](const std::string&) {});
    const auto page = std::make_shared<Page>();
    viewer.received(page, showText(1));  // before it was opened: nobody
    viewer.opened(page);
    for (const char* text : {"", "{", R"({"type":"open","file":1})", R"({"type":"show","state":{"size":[1e9,1]}})"}) {
        page->shown.clear();
        viewer.received(page, text);
        EXPECT_FALSE(page->shown.waitFor("refused").is_null()) << text;
    }
    viewer.closed(page);
    viewer.closed(page);
}

TEST(Viewer, ShowsChangesAndFailures) {
    const test::ScratchFolder folder;
    const std::string path = (folder / "part.gcode").string();
    std::filesystem::copy_file(test::dataDir() / "gcode/tile.gcode", path);
    std::mutex mutex;
    std::vector<std::string> said;
    Viewer viewer({inputAt(path)}, [&](const std::string& text) {
        const std::lock_guard lock(mutex);
        said.push_back(text);
    });
    EXPECT_GE(viewer.descriptor(), 0);
    const auto page = std::make_shared<Page>();
    viewer.opened(page);
    viewer.received(page, showText(1));
    EXPECT_FALSE(page->shown.waitFor("picture", 1, "final").is_null());
    page->shown.clear();
    std::ofstream(path) << "this is no G-code\n";
    viewer.changed({path});
    EXPECT_FALSE(page->shown.waitFor("failed").is_null());
    page->shown.clear();
    std::filesystem::copy_file(test::dataDir() / "gcode/tile_arcs.gcode", path,
                               std::filesystem::copy_options::overwrite_existing);
    viewer.changed({path});
    EXPECT_FALSE(page->shown.waitFor("facts").is_null());
    {
        // A page tells of every picture that it has shown; the next moving one waits for that.
        const std::jthread shows([&](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
                viewer.received(page, R"({"type":"shown"})");
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
            }
        });
        viewer.received(page, showText(2));
        EXPECT_FALSE(page->shown.waitFor("picture", 2, "moving").is_null());
    }
    viewer.closed(page);
    const std::lock_guard lock(mutex);
    EXPECT_GE(said.size(), 3U);
}

// What a page has sent is a further input of all pages, and goes with the viewer.
TEST(Viewer, TakesFilesOfPages) {
    std::filesystem::path kept;
    {
        const auto read = [](const std::string& path) {
            if (path.ends_with(".json")) throw InputError("no scenes");
            return inputAt(path);
        };
        Viewer viewer(
            {test::givenTile(0.2)}, [](const std::string&) {}, read);
        std::vector<std::shared_ptr<Page>> pages{std::make_shared<Page>(), std::make_shared<Page>()};
        for (const auto& page : pages) {
            viewer.opened(page);
            EXPECT_GT(page->shown.waitFor("hello")["takes"], 1e6);
            EXPECT_FALSE(page->shown.waitFor("facts").is_null());
        }
        kept = viewer.incoming("../../C:\\prints\\.two tone\n.gcode");
        EXPECT_EQ(kept.filename(), "two tone .gcode");
        EXPECT_NE(viewer.incoming("two tone .gcode"), kept);
        std::filesystem::copy_file(test::dataDir() / "gcode/two_tone.gcode", kept);
        EXPECT_EQ(viewer.arrived(kept), "1");
        for (const auto& page : pages)
            EXPECT_EQ(page->shown.waitFor("files")["files"], (nlohmann::json{"tile.gcode", "two tone .gcode"}));
        pages.front()->shown.clear();
        viewer.received(pages.front(), R"({"type":"open","file":1})");
        EXPECT_EQ(pages.front()->shown.waitFor("facts")["facts"]["print"]["tools"].size(), 2U);
        const std::filesystem::path scene = viewer.incoming("scene.json");
        std::ofstream(scene) << "{}";
        EXPECT_THROW(viewer.arrived(scene), InputError);
        EXPECT_FALSE(std::filesystem::exists(scene));
        for (const auto& page : pages) viewer.closed(page);
        EXPECT_TRUE(std::filesystem::exists(kept));
    }
    EXPECT_FALSE(std::filesystem::exists(kept.parent_path().parent_path()));
    Viewer takes_none({test::givenTile(0.2)}, [](const std::string&) {});
    EXPECT_THROW(takes_none.incoming("part.gcode"), InputError);
}

TEST(SentFiles, WithoutAFolderForThemTheyAreRefused) {
    const char* const set = std::getenv("TMPDIR");
    const std::string before = set == nullptr ? "" : set;
    ::setenv("TMPDIR", "/nowhere/at/all", 1);
    SentFiles files;
    EXPECT_THROW((void)files.place("part.gcode"), InputError);
    if (set == nullptr)
        ::unsetenv("TMPDIR");
    else
        ::setenv("TMPDIR", before.c_str(), 1);
    EXPECT_EQ(files.place("part.gcode").filename(), "part.gcode");
}

TEST(Viewer, ForgetsInputsThatNobodyLooksAt) {
    std::mutex mutex;
    std::vector<std::string> said;
    Viewer viewer({inputAt((test::dataDir() / "gcode/tile.gcode").string()),
                   inputAt((test::dataDir() / "gcode/two_tone.gcode").string()),
                   inputAt((test::dataDir() / "gcode/tile_arcs.gcode").string())},
                  [&](const std::string& text) {
                      const std::lock_guard lock(mutex);
                      said.push_back(text);
                  });
    const auto page = std::make_shared<Page>();
    viewer.opened(page);
    EXPECT_FALSE(page->shown.waitFor("facts").is_null());
    // The files that are read when these inputs are opened one after the other.
    const auto read = [&](std::initializer_list<int> files) {
        {
            const std::lock_guard lock(mutex);
            said.clear();
        }
        for (const int file : files) {
            page->shown.clear();
            viewer.received(page, nlohmann::json{{"type", "open"}, {"file", file}}.dump());
            EXPECT_FALSE(page->shown.waitFor("facts").is_null());
        }
        const std::lock_guard lock(mutex);
        return said.size();
    };
    EXPECT_EQ(read({1, 0, 1, 0}), 1U);  // two stay ready
    EXPECT_EQ(read({1, 2, 1, 2}), 1U);
    EXPECT_EQ(read({0}), 1U);  // it was left before the others
    EXPECT_EQ(read({2, 0}), 0U);
    EXPECT_EQ(read({1}), 1U);
    // An input that another page looks at stays.
    const auto other = std::make_shared<Page>();
    viewer.opened(other);
    EXPECT_EQ(read({2, 1, 2, 0}), 1U);
    viewer.closed(other);
    viewer.closed(page);
}

// Pages come and go while their pictures are made.
TEST(Viewer, EndsAmidWork) {
    std::vector<std::shared_ptr<Page>> pages;
    Viewer viewer({test::givenTile(0.2), test::givenTile(0.1)}, [](const std::string&) {});
    for (int n = 0; n < 6; ++n) {
        pages.push_back(std::make_shared<Page>());
        viewer.opened(pages.back());
        viewer.received(pages.back(), showText(1));
        if (n % 2 == 0) viewer.received(pages.back(), R"({"type":"open","file":1})");
        if (n % 3 == 0) viewer.closed(pages.back());
    }
    EXPECT_FALSE(pages[1]->shown.waitFor("picture", 1, "moving").is_null());
}

}  // namespace
}  // namespace stratum::view
