#include "animate/camera_path.h"

#include "base/error.h"
#include "refusal.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <fstream>
#include <string>

namespace stratum::animate {
namespace {

std::vector<CameraKey> read(const std::string& text) {
    const test::ScratchFolder folder;
    std::ofstream(folder / "path.json") << text;
    return readCameraKeys(folder / "path.json");
}

std::string complaint(const std::string& text) {
    return test::messageOf<InputError>([&] { (void)read(text); }, "none");
}

TEST(CameraPath, PassesThroughItsKeys) {
    const auto keys = read(R"({"keys": [{"time": 1, "eye": [10, -20, 30]},
        {"time": 2, "eye": [40, 0, 5], "look_at": [1, 2, 3], "up": [0, 1, 1], "fov": 20},
        {"time": 5, "eye": [0, 50, 60.25], "fov": 35}]})");
    ASSERT_EQ(keys.size(), 3u);
    EXPECT_EQ(durationOf(keys), 4.0);
    const glm::dvec3 middle(7, 8, 9);
    const CameraPath path(keys, middle, 28.0);
    shade::CameraOptions camera;
    const auto expect = [&](double share, const glm::dvec3& eye, const glm::dvec3& look_at, const glm::dvec3& up,
                            double fov) {
        path.place(share, camera);
        EXPECT_EQ(*camera.eye, eye);
        EXPECT_EQ(*camera.look_at, look_at);
        EXPECT_EQ(*camera.up, up);
        EXPECT_EQ(camera.fov, fov);
    };
    expect(0.0, {10, -20, 30}, middle, {0, 0, 1}, 28.0);
    expect(0.25, {40, 0, 5}, {1, 2, 3}, {0, 1, 1}, 20.0);
    expect(1.0, {0, 50, 60.25}, middle, {0, 0, 1}, 35.0);
}

TEST(CameraPath, MovesSmoothlyAndStaysAboveTheBed) {
    const CameraPath path(read(R"({"keys": [{"time": 0, "eye": [100, 0, 80]}, {"time": 1, "eye": [0, 100, 1]},
        {"time": 1.2, "eye": [-100, 0, 1]}, {"time": 3, "eye": [0, -100, 90]}]})"),
                          {0, 0, 0}, 28.0);
    shade::CameraOptions camera;
    path.place(0.0, camera);
    glm::dvec3 before = *camera.eye;
    glm::dvec3 step_before(0.0);
    for (int n = 1; n <= 3000; ++n) {
        path.place(n / 3000.0, camera);
        EXPECT_GE(camera.eye->z, 1.0);
        const glm::dvec3 step = *camera.eye - before;
        if (n > 1) {
            EXPECT_LT(glm::length(step - step_before), 0.05);  // of up to 0.6 a step
        }
        before = *camera.eye;
        step_before = step;
    }
}

TEST(CameraPath, SaysWhatIsWrongWithAFile) {
    const auto mentions = [](const std::string& text, const std::string& json) {
        const std::string said = complaint(json);
        EXPECT_NE(said.find(text), std::string::npos) << said;
    };
    mentions("did you mean 'look_at'?",
             R"({"keys": [{"time": 0, "eye": [0,0,0], "lok_at": [1,1,1]}, {"time": 1, "eye": [1,1,1]}]})");
    mentions("keys[1].tim: unknown", R"({"keys": [{"time": 0, "eye": [0,0,0]}, {"tim": 1, "eye": [1,1,1]}]})");
    mentions("did you mean 'keys'?", R"({"key": []})");
    mentions("keys: expected a list of two or more", R"({"keys": [{"time": 0, "eye": [0,0,0]}]})");
    mentions("keys[1].time: is 1, and the key before has 1",
             R"({"keys": [{"time": 1, "eye": [0,0,0]}, {"time": 1, "eye": [1,1,1]}]})");
    mentions("a microsecond apart", R"({"keys": [{"time": 0, "eye": [0,0,0]}, {"time": 1e-300, "eye": [1,1,1]}]})");
    mentions("keys[0].eye: expected 3 numbers of at most 1e9",
             R"({"keys": [{"time": 0, "eye": [0,0,1e300]}, {"time": 1, "eye": [1,1,1]}]})");
    mentions("keys[0].eye: expected 3 numbers",
             R"({"keys": [{"time": 0, "eye": [0,0]}, {"time": 1, "eye": [1,1,1]}]})");
    mentions("keys[0].eye: expected 3 numbers", R"({"keys": [{"time": 0}, {"time": 1, "eye": [1,1,1]}]})");
    mentions("keys[1].time: expected a number", R"({"keys": [{"time": 0, "eye": [0,0,0]}, {"eye": [1,1,1]}]})");
    mentions("keys[1].fov: expected an angle",
             R"({"keys": [{"time": 0, "eye": [0,0,0]}, {"time": 1, "eye": [1,1,1], "fov": 180}]})");
    mentions("is no JSON", R"({"keys": [)");
    mentions("is no JSON", R"({"keys": [{"time": 1, "eye": [0, 0, 1e3082]}]})");  // more than any double
    mentions("expected an object", "[]");
}

}  // namespace
}  // namespace stratum::animate
