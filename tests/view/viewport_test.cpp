#include "view/viewport.h"

#include "given_tile.h"
#include "shown.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stratum::view {
namespace {

/// A viewport that is worked on by the test itself.
class OnePage {
public:
    OnePage() : scene_(document_), viewport(document_, shown.output()) { viewport.startWith(scene_); }
    void workUntilIdle() {
        viewport.ask(ShownMessage{});
        for (int n = 0; n < 1000 && (viewport.hasWork(false) || viewport.worksAt()); ++n) {
            if (viewport.hasWork(false)) viewport.step([] {});
            viewport.ask(ShownMessage{});
        }
        EXPECT_FALSE(viewport.hasWork(false));
    }

private:
    Document document_{test::givenTile(0.2)};
    ViewScene scene_;

public:
    test::Shown shown;
    Viewport viewport;
};

TEST(Viewport, FromTheQuickPictureToTheFinishedOne) {
    OnePage page;
    EXPECT_FALSE(page.viewport.hasWork(false));
    page.viewport.ask(test::show(7, test::smallState()));
    EXPECT_TRUE(page.viewport.hasWork(true));
    page.workUntilIdle();
    EXPECT_EQ(page.shown.kinds(), (std::vector<std::string>{"moving", "rough", "final"}));
    const auto final = page.shown.waitFor("picture", 7, "final");
    EXPECT_EQ(final["width"], 64);
    EXPECT_NE(final["command"].get<std::string>().find("--size 64x48"), std::string::npos);
}

TEST(Viewport, SendsNoMoreThanThePageTakes) {
    OnePage page;
    for (std::uint64_t number = 1; number <= 6; ++number) {
        page.viewport.ask(test::show(number, test::smallState()));
        if (page.viewport.hasWork(true)) page.viewport.step([] {});
    }
    EXPECT_EQ(page.shown.kinds().size(), 2U);  // that are on their way
    // It does not work on what it may not send, nor begins it again and again.
    EXPECT_FALSE(page.viewport.hasWork(false));
    EXPECT_FALSE(page.viewport.overtaken());
    page.workUntilIdle();
    EXPECT_FALSE(page.shown.waitFor("picture", 6, "final").is_null());
}

TEST(Viewport, AfterAFailureTheOldPictureIsGivenUp) {
    OnePage page;
    page.viewport.ask(test::show(7, test::smallState()));
    for (int n = 0; n < 100 && page.shown.kinds() != std::vector<std::string>{"moving", "rough"}; ++n) {
        page.viewport.step([] {});
        page.viewport.ask(ShownMessage{});
    }
    ASSERT_TRUE(page.viewport.hasWork(false));
    page.viewport.fail("the file is broken");
    EXPECT_FALSE(page.viewport.hasWork(false));
    EXPECT_EQ(page.shown.kinds().size(), 2U);
    EXPECT_EQ(page.shown.waitFor("failed")["text"], "the file is broken");
}

// The processors are the page's while it draws what moves.
TEST(Viewport, GivesUpAPictureWhenThePageDrawsWhatMoves) {
    OnePage page;
    ShowMessage show = test::show(1, test::smallState());
    show.own = true;
    page.viewport.ask(show);
    page.viewport.step([] {});
    EXPECT_TRUE(page.viewport.hasWork(false));
    show.number = 2;
    show.moving = true;
    page.viewport.ask(show);
    page.workUntilIdle();
    EXPECT_TRUE(page.shown.kinds().empty());
    show.number = 3;
    show.moving = false;
    page.viewport.ask(show);
    page.workUntilIdle();
    EXPECT_EQ(page.shown.kinds(), (std::vector<std::string>{"final"}));
}

// The saved picture is of its own view, whatever is looked at meanwhile.
TEST(Viewport, WhatIsSavedIsWhatWasAskedFor) {
    OnePage page;
    page.viewport.ask(test::show(1, test::smallState()));
    page.workUntilIdle();
    ViewState layers = test::smallState(80);
    layers.last_layer = 2;
    page.viewport.ask(SaveMessage{2, layers});
    page.viewport.step([] {});
    ViewState other = test::smallState(96);
    other.named = shade::View::top;
    page.viewport.ask(test::show(3, other));
    page.workUntilIdle();
    const auto saved = page.shown.waitFor("picture", 2, "saved");
    ASSERT_FALSE(saved.is_null());
    EXPECT_EQ(saved["width"], 80);
    const std::string command = saved["command"];
    EXPECT_NE(command.find("--layers 1:2"), std::string::npos) << command;
    EXPECT_NE(command.find("--view iso"), std::string::npos) << command;
    EXPECT_NE(saved["camera"], page.shown.waitFor("picture", 3, "final")["camera"]);
}

ViewState upTo(int last_layer) {
    ViewState state = test::smallState();
    state.last_layer = last_layer;
    return state;
}

TEST(Viewport, TheViewHasItsOwnObjectsAfterASaveOfOthers) {
    OnePage page;
    page.viewport.ask(test::show(1, upTo(2)));
    page.workUntilIdle();
    page.viewport.ask(test::show(3, upTo(2)));
    page.viewport.ask(SaveMessage{2, upTo(4)});
    page.workUntilIdle();
    const auto before = page.shown.waitFor("picture", 1, "final"), after = page.shown.waitFor("picture", 3, "final");
    ASSERT_FALSE(before.is_null() || after.is_null());
    EXPECT_TRUE(before["bytes"] == after["bytes"]);
    EXPECT_TRUE(before["bytes"] != page.shown.waitFor("picture", 2, "saved")["bytes"]);
}

TEST(Viewport, ASaveThatFailsSpoilsNoView) {
    OnePage page;
    page.viewport.ask(test::show(1, upTo(2)));
    ViewState nothing = test::smallState();
    nothing.first_layer = 4000;
    nothing.last_layer = 4001;
    page.viewport.ask(SaveMessage{2, nothing});
    page.workUntilIdle();
    EXPECT_NE(page.shown.waitFor("not-saved")["text"].get<std::string>().find("layers"), std::string::npos);
    EXPECT_EQ(page.shown.kinds().back(), "final");
    // The next one is saved.
    page.viewport.ask(SaveMessage{3, upTo(4)});
    page.workUntilIdle();
    EXPECT_FALSE(page.shown.waitFor("picture", 3, "saved").is_null());
}

// One that is given up is not taken for the next one.
TEST(Viewport, ASavedPictureThatIsGivenUpGivesWay) {
    OnePage page;
    page.viewport.ask(test::show(1, test::smallState()));
    page.workUntilIdle();
    page.viewport.ask(SaveMessage{2, test::smallState(80)});
    page.viewport.step([] {});  // is begun
    page.viewport.ask(CancelMessage{});
    page.viewport.ask(SaveMessage{3, test::smallState(96)});
    page.workUntilIdle();
    const auto saved = page.shown.waitFor("picture", 3, "saved");
    ASSERT_FALSE(saved.is_null());
    EXPECT_EQ(saved["width"], 96);
    for (const std::string& kind : page.shown.kinds()) EXPECT_TRUE(kind != "saved" || saved["number"] == 3);
}

TEST(Viewport, WhatFailsIsTold) {
    OnePage page;
    ViewState state = test::smallState();
    state.first_layer = 4000;
    state.last_layer = 4001;
    page.viewport.ask(test::show(1, state));
    page.workUntilIdle();
    EXPECT_FALSE(page.shown.waitFor("failed", 1).is_null());
    page.viewport.ask(test::show(2, test::smallState()));
    page.workUntilIdle();
    EXPECT_FALSE(page.shown.waitFor("picture", 2, "final").is_null());
}

TEST(Viewport, InspectsThePicture) {
    OnePage page;
    ViewState state = test::smallState();
    state.named = shade::View::top;
    page.viewport.ask(test::show(1, state));
    page.viewport.ask(InspectMessage{2, 0.5, 0.5});
    page.workUntilIdle();
    const auto found = page.shown.waitFor("inspected", 2);
    ASSERT_FALSE(found.is_null());
    EXPECT_TRUE(found["hit"]);
}

// Clicks and lines that are asked for while the beads are on their way take none of the page's places.
TEST(Viewport, ClicksBetweenPartsOfATableHoldNothingUp) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    std::size_t sent = 0, taken = 0;
    Viewport viewport(document, {[](const nlohmann::json&) {},
                                 [&](const nlohmann::json&, const std::vector<std::uint8_t>&) { ++sent; }});
    viewport.startWith(scene);
    const auto workUntilIdle = [&] {
        for (int n = 0; n < 1000 && (viewport.hasWork(false) || viewport.worksAt()); ++n) {
            if (viewport.hasWork(false)) viewport.step([] {});
            for (; taken < sent; ++taken) viewport.ask(ShownMessage{});
        }
    };
    viewport.ask(test::show(1, test::smallState()));
    workUntilIdle();
    for (int n = 0; n < 3; ++n) {
        viewport.ask(BeadsMessage{});
        viewport.ask(MovesMessage{});
        viewport.ask(InspectMessage{2, 0.5, 0.5});
        viewport.ask(ProgramMessage{3});
        workUntilIdle();
    }
    const std::size_t before = sent;
    viewport.ask(test::show(3, test::smallState(80)));
    workUntilIdle();
    EXPECT_EQ(sent, before + 3);  // moving, rough, final
}

// Layers, lines of the program: told once each, and what can't be told spoils no picture.
TEST(Viewport, TellsOfLayersAndLines) {
    OnePage page;
    page.viewport.ask(test::show(1, test::smallState()));
    page.workUntilIdle();
    page.viewport.ask(LayersMessage{});
    page.viewport.ask(ProgramMessage{5});
    page.workUntilIdle();
    const auto layers = page.shown.waitFor("layers");
    const auto program = page.shown.waitFor("program");
    ASSERT_FALSE(layers.is_null() || program.is_null());
    ASSERT_EQ(layers["z"].size(), layers["seconds"].size());
    EXPECT_NEAR(layers["z"][2].get<double>() - layers["z"][1].get<double>(), 0.2, 1e-9);
    EXPECT_GT(layers["seconds"][2], 0.0);
    EXPECT_EQ(program["lines"].size(), 9U);
    EXPECT_EQ(program["lines"][4]["number"], program["line"]);
    page.viewport.ask(ProgramMessage{4000000000U});
    page.workUntilIdle();
    EXPECT_NE(page.shown.waitFor("refused")["text"].get<std::string>().find("no such bead"), std::string::npos);
    EXPECT_TRUE(page.shown.kinds().back() == "final");
}

}  // namespace
}  // namespace stratum::view
