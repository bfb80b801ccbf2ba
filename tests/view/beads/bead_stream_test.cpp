#include "view/beads/bead_stream.h"

#include "given_tile.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace stratum::view {
namespace {

/// What a page would get.
struct Page {
    std::vector<std::pair<nlohmann::json, std::size_t>> bytes;  // heads, and sizes of what follows
    std::vector<nlohmann::json> texts;
    Output output{[this](const nlohmann::json& message) { texts.push_back(message); },
                  [this](const nlohmann::json& head, const std::vector<std::uint8_t>& file) {
                      bytes.emplace_back(head, file.size());
                  }};
};

TEST(BeadStream, SendsTheTableInParts) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    scene.makeObjects(planPicture(document.given(), {}), {});
    Page page;
    BeadStream stream(document, page.output);
    while (stream.sendPart()) {
    }
    ASSERT_GE(page.bytes.size(), 2U);
    const nlohmann::json& head = page.bytes.front().first;
    EXPECT_EQ(head["type"], "beads");
    EXPECT_EQ(page.bytes.front().second, 20 * head["runs"].get<std::size_t>());
    std::size_t size = 0;
    for (std::size_t n = 1; n < page.bytes.size(); ++n) size += page.bytes[n].second;
    EXPECT_EQ(size, 16 * head["beads"].get<std::size_t>());
}

TEST(BeadStream, SaysWhyItHasNone) {
    view::GivenInput given = test::givenTile(0.2);
    given.options.tracing.prints.print.layers = "1:3";
    Document document(std::move(given));
    ViewScene scene(document);
    Page page;
    BeadStream stream(document, page.output);
    EXPECT_FALSE(stream.sendPart());  // nothing is read yet
    scene.makeObjects(planPicture(document.given(), {}), {});
    EXPECT_FALSE(stream.sendPart());
    ASSERT_EQ(page.bytes.size(), 2U);
    EXPECT_EQ(page.bytes.back().first["type"], "no-beads");
    EXPECT_NE(page.bytes.back().first["text"].get<std::string>().find("command line"), std::string::npos);
}

// Light and colours are sent when they change, and turning sends neither.
TEST(BeadStream, SendsAChangedLook) {
    Document document(test::givenTile(0.2));
    ViewScene scene(document);
    Page page;
    BeadStream stream(document, page.output);
    ViewState state;
    state.width = state.height = 64;
    const auto look = [&] {
        const PicturePlan plan = planPicture(document.given(), state);
        scene.makeObjects(plan, {});
        stream.sendLook(scene.picture(plan, 64, 64), plan, scene, 1);
        return page.texts.back();
    };
    EXPECT_EQ(look()["light"].size(), 2U * 32 * 32);
    ASSERT_EQ(page.bytes.size(), 1U);
    EXPECT_EQ(page.bytes.back().second, 0U);  // one colour
    state.named = shade::View::front;
    const nlohmann::json turned = look();
    EXPECT_FALSE(turned.contains("light"));
    EXPECT_TRUE(turned["follows"]);
    EXPECT_EQ(page.bytes.size(), 1U);
    state.color_by = "feature";
    (void)look();
    ASSERT_EQ(page.bytes.size(), 2U);
    EXPECT_EQ(page.bytes.back().second, 2 * document.toolpath(0)->beads.size());
    EXPECT_GT(page.bytes.back().first["palette"].size(), 2U);
}

}  // namespace
}  // namespace stratum::view
