#include "voxelize/swell/node_sums.h"

#include "voxelize/leaf/swell_kernels.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstring>
#include <random>
#include <vector>

namespace stratum::voxelize {
namespace {

// From the middle of a square of two by two cells, mm.
ColumnGrid points() {
    constexpr float kVoxel = kSquareCells * static_cast<float>(kNodeSpacing) / 8;
    ColumnGrid grid = ColumnGrid::spread(kVoxel);
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        grid.qx.v[c] -= 0.5F * kVoxel;
        grid.qy.v[c] -= 0.5F * kVoxel;
    }
    return grid;
}

PlanField randomField(unsigned seed, float least, float most) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(least, most);
    PlanField field;
    for (float& v : field.v) v = value(random);
    return field;
}

TEST(NodeSums, WeighPointsByTheTentsOfTheNodes) {
    const ColumnGrid grid = points();
    const NodeSums sums(grid);
    std::array<PlanField, NodeSums::kFields> fields;
    for (unsigned n = 0; n < fields.size(); ++n) fields[n] = randomField(n, 0, 0.2F);
    const NodeSums::Sums by_node = sums.of(fields);
    constexpr double kArea = 4 * kNodeSpacing * kNodeSpacing / kColumnSamples;
    for (std::size_t node = 0; node < NodeSums::kNodes; ++node) {
        double area = 0;
        std::array<double, NodeSums::kFields> expected{};
        for (std::size_t c = 0; c < kColumnSamples; ++c) {
            const double x = std::abs(grid.qx.v[c] / kNodeSpacing + 1 - static_cast<double>(node % 3));
            const double y = std::abs(grid.qy.v[c] / kNodeSpacing + 1 - static_cast<double>(node / 3));
            const double weight = kArea * nodeShare(std::max(1 - x, 0.0)) * nodeShare(std::max(1 - y, 0.0));
            area += weight;
            for (std::size_t n = 0; n < fields.size(); ++n) expected[n] += weight * static_cast<double>(fields[n].v[c]);
        }
        EXPECT_NEAR(sums.area(node), area, 1e-7);
        for (std::size_t n = 0; n < fields.size(); ++n) EXPECT_NEAR(by_node[node][n], expected[n], 1e-8) << node;
    }
}

TEST(PressedLayer, HoldsAndGainsWhatTheSectionDoes) {
    PlanField sides2;
    for (std::size_t c = 0; c < kColumnSamples; ++c) sides2.v[c] = 0.0006F * static_cast<float>(c);
    PressedLayer pressed;
    pressLayer(sides2, 0.1F, 0.06F, 1, pressed);
    ASSERT_EQ(pressed.kind, PressedLayer::Kind::some);
    const auto thickness = [](double side) { return side < 0.1 ? 0.06 + 2 * std::sqrt(0.01 - side * side) : 0; };
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double side = std::sqrt(static_cast<double>(sides2.v[c]));
        for (std::size_t n = 0; n < PressedLayer::kFields; ++n) {
            const double moved = std::max(side - (n > 0 ? TileSums::kSwells[n - 1] : 0), 0.0);
            const double expected = n > 0 ? thickness(moved) - thickness(side) : -thickness(side);
            EXPECT_NEAR(pressed.fields[n].v[c], expected, std::abs(moved - 0.1) < 5e-4 ? 0.07 : 1e-6) << c << " " << n;
        }
        EXPECT_EQ(pressed.solid >> c & 1, pressed.fields[0].v[c] < 0 ? 1U : 0U);
    }
    sides2 = {};
    pressLayer(sides2, 0.1F, 0.06F, 1, pressed);
    EXPECT_EQ(pressed.kind, PressedLayer::Kind::flat);
    std::fill(std::begin(sides2.v), std::end(sides2.v), 0.041F);
    pressLayer(sides2, 0.1F, 0.06F, 1, pressed);
    EXPECT_EQ(pressed.kind, PressedLayer::Kind::nothing);
}

TEST(SwellKernels, InterpolateAndCrownAsDefined) {
    const ColumnGrid grid = points();
    // Nodes 0 .. 3 and 0 .. 2; the square's first corner lies 0.7 and 0.1 past node 0.
    std::vector<PlanField> x(3);
    std::vector<PlanField> y(2);
    nodeRamps(grid.qx, static_cast<float>(1 / kNodeSpacing), 1.2F, x);
    nodeRamps(grid.qy, static_cast<float>(1 / kNodeSpacing), 1, y);
    std::vector<float> nodes(12);
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = 0.01F * static_cast<float>(n * n % 7);
    PlanField values;
    std::vector<float> scratch = nodes;
    betweenNodes(x, y, scratch, 2, values);
    PlanField lowered = values;
    const PlanField nearest = randomField(7, -0.3F, 0.3F);
    lowerByCrown(values, nearest, 0.04F, 0.1F, lowered);
    for (std::size_t c = 0; c < kColumnSamples; ++c) {
        const double at_x = grid.qx.v[c] / kNodeSpacing + 1.2;
        const double at_y = grid.qy.v[c] / kNodeSpacing + 1;
        double expected = 0;
        for (std::size_t n = 0; n < nodes.size(); ++n)
            expected += 2 * static_cast<double>(nodes[n]) *
                        nodeShare(std::max(1 - std::abs(at_x - static_cast<double>(n % 4)), 0.0)) *
                        nodeShare(std::max(1 - std::abs(at_y - static_cast<double>(n / 4)), 0.0));
        EXPECT_NEAR(values.v[c], expected, 1e-7) << c;
        const double depth = crownDepth(0.04, 0.1, static_cast<double>(nearest.v[c]));
        EXPECT_NEAR(lowered.v[c], expected * (1 - depth), 1e-7) << c;
    }
}

TEST(NodeSums, GoToARowOfEachKind) {
    std::vector<TileSums::Node> nodes(39);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        const auto value = static_cast<float>(n);
        nodes[n] = {value, {100 + value, 200 + value, 300 + value}};
    }
    std::vector<float> rows[4];
    for (std::vector<float>& row : rows) row.assign(nodes.size() + 1, 0.5F);
    addNodes(nodes, rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data());
    for (std::size_t kind = 0; kind < 4; ++kind) {
        for (std::size_t n = 0; n < nodes.size(); ++n)
            EXPECT_EQ(rows[kind][n], 100 * static_cast<float>(kind) + static_cast<float>(n) + 0.5F);
        EXPECT_EQ(rows[kind].back(), 0.5F) << "beyond the row";
    }
}

TEST(SwellKernels, EveryInstructionSetGivesTheSameBytes) {
    const ColumnGrid grid = points();
    const PlanField sides2 = randomField(3, -0.004F, 0.05F);
    struct Result {
        PlanField values, lowered;
        std::array<PlanField, PressedLayer::kFields> fields;
        NodeSums::Sums sums;
        std::uint64_t solid;
    };
    std::vector<Result> results;
    for (std::int64_t rest = hwy::SupportedTargets() & ~HWY_DISABLED_TARGETS; rest != 0; rest &= rest - 1) {
        hwy::SetSupportedTargetsForTest(rest & -rest);
        Result r{};
        std::vector<PlanField> ramps(2);
        nodeRamps(grid.qx, 2.5F, 1, ramps);
        float nodes[9] = {0, 0.1F, 0.05F, 0.07F, 0.02F, 0, 0.03F, 0.09F, 0.1F};
        betweenNodes(ramps, ramps, nodes, 1, r.values);
        r.lowered = r.values;
        lowerByCrown(r.values, randomField(7, -0.3F, 0.3F), 0.04F, 0.1F, r.lowered);
        PlanField positive = sides2;
        for (float& v : positive.v) v = std::max(v, 0.0F);
        PressedLayer pressed;
        pressLayer(positive, 0.1F, 0.06F, 1, pressed);
        r.fields = pressed.fields;
        r.solid = pressed.solid;
        r.sums = NodeSums(grid).of(pressed.fields);
        results.push_back(r);
    }
    hwy::SetSupportedTargetsForTest(0);
    for (const Result& r : results) EXPECT_EQ(std::memcmp(&r, &results[0], sizeof r), 0);
}

}  // namespace
}  // namespace stratum::voxelize
