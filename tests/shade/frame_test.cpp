#include "shade/frame.h"

#include "shade/camera/sampling.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

TEST(Frame, IsOrthonormalForEveryNormal) {
    std::vector<glm::vec3> normals = {{0, 0, 1}, {0, 0, -1}, {0, 0, -0.0f}, {1, 0, 0}, {0, -1, 0}, {0, 1e-20f, -1}};
    normals[2] = {0, 1, -0.0f};
    for (int i = 0; i < 50; ++i)
        for (int j = 0; j < 50; ++j) normals.push_back(shade::toSphere({(i + 0.5f) / 50, (j + 0.5f) / 50}));
    for (const glm::vec3& n : normals) {
        const shade::Frame f(n);
        EXPECT_NEAR(glm::dot(f.x, f.y), 0.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(f.x, n), 0.0f, 1e-6f);
        EXPECT_NEAR(glm::dot(f.y, n), 0.0f, 1e-6f);
        EXPECT_NEAR(glm::length(f.x), 1.0f, 1e-6f);
        EXPECT_NEAR(glm::length(glm::cross(f.x, f.y) - n), 0.0f, 2e-6f);
        const glm::vec3 v(0.3f, -0.5f, 0.8f);
        EXPECT_NEAR(glm::length(f.toLocal(f.toWorld(v)) - v), 0.0f, 1e-6f);
    }
}

// The last bit of a vertical wall's normal is rounding, and must not decide where rays go.
TEST(Frame, IsTheSameOnBothSidesOfUpright) {
    for (const float z : {0.0f, -0.0f, 1e-16f, -1e-16f}) {
        const shade::Frame f(glm::vec3(0.6f, -0.8f, z));
        EXPECT_NEAR(glm::length(f.x - glm::vec3(0.64f, 0.48f, -0.6f)), 0.0f, 1e-6f) << z;
        EXPECT_NEAR(glm::length(f.y - glm::vec3(0.48f, 0.36f, 0.8f)), 0.0f, 1e-6f) << z;
    }
}

}  // namespace
}  // namespace stratum
