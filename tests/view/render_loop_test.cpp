#include "view/render_loop.h"

#include "given_tile.h"
#include "shown.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <memory>
#include <thread>
#include <vector>

namespace stratum::view {
namespace {

/// A document and what looks at it.
struct LoopedPages {
    explicit LoopedPages(int count) : scene(document) {
        for (int n = 0; n < count; ++n) {
            shown.push_back(std::make_unique<test::Shown>());
            viewports.push_back(std::make_shared<Viewport>(document, shown.back()->output()));
            viewports.back()->startWith(scene);
        }
    }
    Document document{test::givenTile(0.2)};
    ViewScene scene;
    std::vector<std::unique_ptr<test::Shown>> shown;
    std::vector<std::shared_ptr<Viewport>> viewports;
};

TEST(RenderLoop, RunsTasksInOrder) {
    std::vector<int> order;
    std::promise<void> done;
    RenderLoop loop;
    for (int n = 0; n < 100; ++n) loop.post([&order, n] { order.push_back(n); });
    loop.post([&done] { done.set_value(); });
    done.get_future().wait();
    ASSERT_EQ(order.size(), 100U);
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
}

TEST(RenderLoop, AllPagesGetTheirPictures) {
    LoopedPages pages(3);
    RenderLoop loop;
    for (const auto& viewport : pages.viewports) loop.add(viewport);
    // Pages ask and take from other threads.
    std::vector<std::thread> threads;
    for (std::size_t n = 0; n < pages.viewports.size(); ++n)
        threads.emplace_back([&, n] {
            for (std::uint64_t number = 1; number <= 5; ++number) {
                pages.viewports[n]->ask(test::show(number, test::smallState()));
                pages.viewports[n]->ask(ShownMessage{});
                loop.wake();
                std::this_thread::yield();
            }
        });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t n = 0; n < pages.viewports.size(); ++n) {
        for (int taken = 0; taken < 8; ++taken) {
            pages.viewports[n]->ask(ShownMessage{});
            loop.wake();
        }
        EXPECT_FALSE(pages.shown[n]->waitFor("picture", 5, "final").is_null()) << n;
    }
}

// What is being finished gives way to what is asked for now.
TEST(RenderLoop, PutsOffWhatIsNotUrgent) {
    LoopedPages pages(2);
    RenderLoop loop;
    for (const auto& viewport : pages.viewports) loop.add(viewport);
    ViewState large = test::smallState(1024);
    large.height = 768;
    large.spp = 64;
    pages.viewports[0]->ask(test::show(1, large));
    loop.wake();
    EXPECT_FALSE(pages.shown[0]->waitFor("picture", 1, "moving").is_null());
    pages.viewports[1]->ask(test::show(2, test::smallState()));
    loop.wake();
    EXPECT_FALSE(pages.shown[1]->waitFor("picture", 2, "moving").is_null());
    EXPECT_EQ(pages.shown[0]->kinds().back() == "final", false);
    std::promise<void> done;
    loop.post([&done] { done.set_value(); });
    EXPECT_EQ(done.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
}

TEST(RenderLoop, EndsAndForgetsAmidWork) {
    LoopedPages pages(2);
    {
        RenderLoop loop;
        for (const auto& viewport : pages.viewports) loop.add(viewport);
        ViewState large = test::smallState(1024);
        large.height = 768;
        large.spp = 256;
        for (const auto& viewport : pages.viewports) viewport->ask(test::show(1, large));
        loop.wake();
        EXPECT_FALSE(pages.shown[0]->waitFor("picture", 1, "moving").is_null());
        loop.remove(pages.viewports[0]);
    }
    EXPECT_NE(pages.shown[1]->kinds(), (std::vector<std::string>{"moving", "rough", "final"}));
}

}  // namespace
}  // namespace stratum::view
