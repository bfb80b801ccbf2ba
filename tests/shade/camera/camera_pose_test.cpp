#include "shade/camera/camera_pose.h"

#include "base/error.h"
#include "refusal.h"
#include "shade/camera/camera.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace stratum {
namespace {

using shade::PointPair;
using shade::solveCameraPose;

constexpr int kWidth = 1600;
constexpr int kHeight = 1200;

// Corners and other places of a part of 60 x 40 x 30 mm, as a camera sees them.
std::vector<PointPair> seenBy(const shade::Camera& camera, int count, double noise, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> where(0, 1);
    std::normal_distribution<double> off(0, noise);
    std::vector<PointPair> pairs;
    for (int n = 0; n < count; ++n) {
        const glm::dvec3 p = n < 8 ? glm::dvec3((n & 1) * 60, (n >> 1 & 1) * 40, (n >> 2 & 1) * 30)
                                   : glm::dvec3(where(random) * 60, where(random) * 40, where(random) * 30);
        const auto pixel = camera.project(p + glm::dvec3(100, 90, 0));
        pairs.push_back({*pixel, p + glm::dvec3(100, 90, 0)});
        if (noise > 0) pairs.back().pixel += glm::dvec2(off(random), off(random));
    }
    return pairs;
}

shade::Camera photographer(double fov = 31.0) {
    return {{250, -120, 140}, {131, 108, 12}, {0.1, 0.05, 1}, fov, kWidth, kHeight};
}

std::string refusal(const std::vector<PointPair>& pairs) {
    return test::messageOf<InputError>([&] { solveCameraPose(pairs, kWidth, kHeight); }, "(none)");
}

TEST(CameraPose, FindsTheCameraOfExactPairs) {
    for (const double fov : {8.0, 31.0, 90.0}) {
        const shade::Camera camera = photographer(fov);
        for (const int count : {6, 7, 8, 20}) {
            const auto pose = solveCameraPose(seenBy(camera, count, 0, 1), kWidth, kHeight);
            EXPECT_NEAR(glm::length(pose.eye - camera.eye()), 0, 1e-5) << fov << " " << count;
            EXPECT_NEAR(pose.fov, fov, 1e-6);
            EXPECT_GT(glm::dot(pose.forward, camera.forward()), 1 - 1e-12);
            EXPECT_GT(glm::dot(pose.up, camera.up()), 1 - 1e-12);
            EXPECT_LT(pose.rms_pixels, 1e-6);
        }
    }
}

TEST(CameraPose, NoiseIsReportedAndAveragedOut) {
    const shade::Camera camera = photographer();
    constexpr double kNoise = 0.5;  // pixels, each axis
    double eye_few = 0;
    double eye_many = 0;
    double rms = 0;
    constexpr int kSeeds = 30;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
        const auto few = solveCameraPose(seenBy(camera, 8, kNoise, seed), kWidth, kHeight);
        const auto many = solveCameraPose(seenBy(camera, 80, kNoise, seed), kWidth, kHeight);
        eye_few += glm::length(few.eye - camera.eye()) / kSeeds;
        eye_many += glm::length(many.eye - camera.eye()) / kSeeds;
        rms += many.rms_pixels / kSeeds;
        // 160 readings, 7 unknowns: what the least squares must leave.
        EXPECT_GE(many.worst_pixels, many.rms_pixels);
        EXPECT_NEAR(many.fov, camera.fov(), 1.0);
    }
    EXPECT_NEAR(rms, kNoise * std::sqrt(2.0 * (160.0 - 7.0) / 160.0), 0.05);
    EXPECT_LT(eye_many, 3.0);
    EXPECT_LT(eye_many, 0.7 * eye_few);
}

TEST(CameraPose, IsAMinimumOfTheResidual) {
    const shade::Camera camera = photographer();
    const auto pairs = seenBy(camera, 12, 1.0, 3);
    const auto pose = solveCameraPose(pairs, kWidth, kHeight);
    const auto rmsOf = [&](const glm::dvec3& eye, double fov) {
        const shade::Camera other(eye, eye + pose.forward, pose.up, fov, kWidth, kHeight);
        double sum = 0;
        for (const auto& pair : pairs) {
            const glm::dvec2 d = *other.project(pair.point) - pair.pixel;
            sum += glm::dot(d, d);
        }
        return std::sqrt(sum / static_cast<double>(pairs.size()));
    };
    // The camera of this house sees what the solver thinks it sees, and every neighbour does worse.
    EXPECT_NEAR(rmsOf(pose.eye, pose.fov), pose.rms_pixels, 1e-9);
    for (int axis = 0; axis < 3; ++axis)
        for (const double step : {-0.02, 0.02}) {
            glm::dvec3 eye = pose.eye;
            eye[axis] += step;
            EXPECT_GT(rmsOf(eye, pose.fov), pose.rms_pixels);
        }
    for (const double step : {-0.01, 0.01}) EXPECT_GT(rmsOf(pose.eye, pose.fov + step), pose.rms_pixels);
}

TEST(CameraPose, AWrongPairIsNamed) {
    auto pairs = seenBy(photographer(), 20, 0.3, 5);
    pairs[13].pixel += glm::dvec2(40, -25);
    const auto pose = solveCameraPose(pairs, kWidth, kHeight);
    EXPECT_EQ(pose.worst, 13u);
    EXPECT_GT(pose.worst_pixels, 20);
}

TEST(CameraPose, RefusesWhatLeavesItOpen) {
    const shade::Camera camera = photographer();
    auto pairs = seenBy(camera, 20, 0, 1);
    EXPECT_NE(refusal({pairs.begin(), pairs.begin() + 5}).find("at least 6"), std::string::npos);
    auto flat = pairs;
    for (auto& pair : flat) {
        pair.point.z = 7;
        pair.pixel = *camera.project(pair.point);
    }
    EXPECT_NE(refusal(flat).find("in a plane"), std::string::npos) << refusal(flat);
    auto line = pairs;
    for (auto& pair : line) pair.point = glm::dvec3(pair.point.x, 90 + 0.5 * pair.point.x, 2 * pair.point.x);
    EXPECT_NE(refusal(line).find("on a line"), std::string::npos) << refusal(line);
    auto same = pairs;
    for (auto& pair : same) pair.point = pairs[0].point;
    EXPECT_NE(refusal(same).find("all points are the same"), std::string::npos) << refusal(same);
    auto mirrored = pairs;
    for (auto& pair : mirrored) pair.pixel.y = kHeight - pair.pixel.y;
    EXPECT_NE(refusal(mirrored).find("mirrored"), std::string::npos) << refusal(mirrored);
    pairs[2].pixel.x = std::nan("");
    EXPECT_NE(refusal(pairs).find("pair 2"), std::string::npos);
    EXPECT_THROW(solveCameraPose(seenBy(camera, 8, 0, 1), 0, 100), InputError);
}

}  // namespace
}  // namespace stratum
