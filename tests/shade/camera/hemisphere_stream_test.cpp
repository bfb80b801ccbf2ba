#include "shade/camera/ray_streams.h"

#include "on_each_target.h"
#include "shade/camera/sampling.h"
#include "shade/frame.h"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <random>
#include <span>
#include <vector>

namespace stratum {
namespace {

class HemisphereStream : public test::OnEachTarget {};

INSTANTIATE_TEST_SUITE_P(Targets, HemisphereStream, test::allTargets(), test::targetName);

/// One at a time, as the header says; zero where it is to be rejected.
glm::dvec3 cosineDirection(const glm::vec3& normal, const glm::vec2& draw) {
    const glm::vec3 local = shade::toCosineHemisphere(draw);
    if (!(local.z > 0.0f)) return glm::dvec3(0.0);
    return glm::normalize(glm::dvec3(shade::Frame(normal).toWorld(local)));
}

TEST_P(HemisphereStream, HasTheBitsOfOneByOne) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> uniform;
    // The axes, the middle of the square, its diagonals, sides and corners; then anything.
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> draws;
    const float below_one = std::nextafter(1.0f, 0.0f);
    for (const glm::vec3& axis : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(1, 0, 0), glm::vec3(0, -1, 0)})
        for (const float u : {0.0f, 0.25f, 0.5f, 0.75f, below_one})
            for (const float v : {0.0f, 0.25f, 0.5f, 0.75f, below_one}) {
                normals.push_back(axis);
                draws.emplace_back(u, v);
            }
    while (normals.size() < 20001) {
        normals.push_back(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
        draws.emplace_back(std::min(uniform(random), below_one), std::min(uniform(random), below_one));
    }
    for (const std::size_t count : {std::size_t{1}, std::size_t{63}, std::size_t{64}, normals.size()}) {
        std::vector<glm::dvec3> directions(count, glm::dvec3(9.0));
        shade::cosineDirections(std::span(normals).first(count), std::span(draws).first(count), directions);
        for (std::size_t n = 0; n < count; ++n) {
            const glm::dvec3 expected = cosineDirection(normals[n], draws[n]);
            if (expected == glm::dvec3(0.0))
                ASSERT_EQ(directions[n], expected) << n;
            else
                ASSERT_EQ(std::memcmp(&directions[n], &expected, sizeof expected), 0) << n;
        }
    }
}

}  // namespace
}  // namespace stratum
