#include "animate/moving_scene.h"

#include "animate/pace.h"
#include "assemble/prints.h"
#include "base/error.h"
#include "refusal.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <set>
#include <string>
#include <utility>

namespace stratum::animate {
namespace {

constexpr std::size_t kFrames = 12;

assemble::StageOptions smallStage() {
    assemble::StageOptions options;
    options.render.width = 40;
    options.render.height = 30;
    return options;
}

assemble::TracedObjects printOf(std::size_t moments, std::size_t held) {
    assemble::TracingOptions tracing = test::coarseTracing();
    tracing.prints.growth = {voxelize::GrowthBy::time, growthShares(moments, held, 0)};
    return assemble::readTracedObjects({test::printOf("tile.gcode")}, tracing);
}

MovingScene sceneOf(Motion motion, std::size_t moments = 1) {
    assemble::TracedObjects objects = printOf(moments, motion.held);
    const assemble::StageOptions options = smallStage();
    assemble::Stage stage = assemble::makeStage(objects, options);
    return {std::move(objects), std::move(stage), options, std::move(motion)};
}

// Rays from above that meet something, of a grid over the print.
int covered(const MovingScene& moving) {
    const trace::Intersector& shape = *moving.objects().intersector;
    const trace::Box box = *moving.objects().part;
    int count = 0;
    for (int x = 0; x < 40; ++x)
        for (int y = 0; y < 40; ++y)
            count += test::hitsFromAbove(shape, box.min.x + (x + 0.5) / 40 * (box.max.x - box.min.x),
                                         box.min.y + (y + 0.5) / 40 * (box.max.y - box.min.y))
                         ? 1
                         : 0;
    return count;
}

TEST(MovingScene, ThePrintGrows) {
    Motion motion;
    motion.frames = kFrames;
    motion.grow = true;
    MovingScene moving = sceneOf(motion, kFrames);
    const glm::dvec3 eye = moving.scene().camera.eye();
    EXPECT_FALSE(moving.repeats(0));
    moving.show(kFrames - 1);
    const int all = covered(moving);
    moving.show(0);
    const int first = covered(moving);
    EXPECT_LT(first, all);
    EXPECT_GT(first, 0);
    moving.show(kFrames - 1);
    EXPECT_EQ(covered(moving), all);
    EXPECT_EQ(moving.scene().camera.eye(), eye);
}

TEST(MovingScene, TheCameraGoesRoundOnce) {
    Motion motion;
    motion.frames = kFrames;
    motion.turns = 1;
    MovingScene moving = sceneOf(motion);
    const trace::Box box = *moving.objects().part;
    const glm::dvec3 middle = 0.5 * (box.min + box.max);
    std::set<long> places;
    double distance = 0;
    for (std::size_t n = 0; n < kFrames; ++n) {
        moving.show(n);
        EXPECT_FALSE(moving.repeats(n));
        const glm::dvec3 eye = moving.scene().camera.eye();
        if (n == 0) distance = glm::length(eye - middle);
        EXPECT_NEAR(glm::length(eye - middle), distance, 1e-9);
        places.insert(std::lround(eye.x * 1e3) * 1000000 + std::lround(eye.y * 1e3));
    }
    EXPECT_EQ(places.size(), kFrames);
    // The last frame is one step before the first, so that it can be repeated.
    moving.show(0);
    const glm::dvec3 first = moving.scene().camera.eye();
    moving.show(1);
    const double step = glm::length(moving.scene().camera.eye() - first);
    moving.show(kFrames - 1);
    EXPECT_NEAR(glm::length(moving.scene().camera.eye() - first), step, 1e-9);
}

TEST(MovingScene, TheCameraFollowsItsPath) {
    Motion motion;
    motion.frames = 5;
    motion.path = {{0, {200, -100, 90}, {}, {}, {}}, {1, {0, -300, 150}, {}, {}, 20.0}, {2, {-100, 0, 60}, {}, {}, {}}};
    MovingScene moving = sceneOf(motion);
    for (const auto& [frame, key] : {std::pair<std::size_t, std::size_t>{0, 0}, {2, 1}, {4, 2}}) {
        moving.show(frame);
        EXPECT_EQ(moving.scene().camera.eye(), motion.path[key].eye);
    }
    moving.show(2);
    EXPECT_DOUBLE_EQ(moving.scene().camera.fov(), 20.0);
    // A camera that looks along its own up, with the frame in the message.
    motion.path[1].look_at = motion.path[1].eye + glm::dvec3(0, 0, -10);
    EXPECT_TRUE(test::refuses<UsageError>("frame 3 of 5", [&] { (void)sceneOf(motion); }));
}

TEST(MovingScene, TheHotEndStandsOnTheLastBead) {
    Motion motion;
    motion.frames = kFrames;
    motion.grow = true;
    motion.nozzle.kind = assemble::HotEndKind::metal;
    MovingScene moving = sceneOf(motion, kFrames);
    ASSERT_EQ(moving.scene().objects.size(), 6u);
    const shade::Camera camera = moving.scene().camera;
    for (const std::size_t n : {std::size_t{0}, std::size_t{5}, kFrames - 1}) {
        moving.show(n);
        const assemble::LazyPrint& print = *moving.objects().prints.front();
        const glm::dvec3 tip = print.tipAt(n);
        const auto& toolpath = *print.finest().layout().toolpath;
        const gcode::Bead& last = toolpath.beads[print.beadsAt(n) - 1];
        EXPECT_EQ(tip, glm::dvec3(last.x1, last.y1, last.z1));
        // From the side: the nozzle's sides are 3.5 mm from its axis. It is smaller above a part smaller than 40 mm.
        const trace::Box part = *moving.objects().part;
        const double scale = std::min(1.0, (part.max.x - part.min.x) / 40);
        trace::Ray ray;
        ray.origin = tip + glm::dvec3(-100, 0, 4.5 * scale);
        ray.direction = {1, 0, 0};
        trace::Hit hit;
        ASSERT_TRUE(moving.objects().intersector->makeTracer()->intersect(ray, hit));
        EXPECT_EQ(hit.object, 2u);
        EXPECT_NEAR(hit.position.x, tip.x - 3.5 * scale, 1e-9);
        EXPECT_EQ(moving.scene().camera.eye(), camera.eye());
    }
}

TEST(MovingScene, TheFinishedPartIsHeldWithoutAHotEnd) {
    for (const auto kind : {assemble::HotEndKind::none, assemble::HotEndKind::metal}) {
        Motion motion;
        motion.frames = kFrames;
        motion.grow = true;
        motion.held = 4;
        motion.nozzle.kind = kind;
        MovingScene moving = sceneOf(motion, kFrames);
        moving.show(kFrames - 5);
        const int grown = covered(moving);
        moving.show(kFrames - 4);
        if (kind == assemble::HotEndKind::none) {
            EXPECT_EQ(covered(moving), grown);
        }
        EXPECT_LT(moving.objects().intersector->bounds().max.z, moving.objects().part->max.z + 2);
        EXPECT_EQ(moving.repeats(kFrames - 4), kind == assemble::HotEndKind::none);
        for (std::size_t n = kFrames - 3; n < kFrames; ++n) EXPECT_TRUE(moving.repeats(n)) << n;
    }
}

TEST(MovingScene, EaseTurnsSlowlyAtBothEnds) {
    Motion motion;
    motion.frames = 100;
    motion.turns = 1;
    motion.ease = 0.25;
    MovingScene moving = sceneOf(motion);
    const auto eyeAt = [&](std::size_t n) {
        moving.show(n);
        return moving.scene().camera.eye();
    };
    const auto step = [&](std::size_t n) { return glm::length(eyeAt(n + 1) - eyeAt(n)); };
    EXPECT_LT(step(0), 0.05 * step(50));
    EXPECT_LT(step(98), 0.2 * step(50));
    EXPECT_NEAR(step(40), step(50), 1e-6 * step(50));
}

TEST(MovingScene, RefusesWhatDoesNotFit) {
    Motion motion;
    motion.frames = kFrames;
    motion.grow = true;
    EXPECT_THROW((void)sceneOf(motion, 3), UsageError);
    EXPECT_THROW((void)sceneOf(motion, 1), UsageError);
}

}  // namespace
}  // namespace stratum::animate
