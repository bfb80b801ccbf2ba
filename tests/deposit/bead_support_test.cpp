#include "deposit/bead_support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace stratum::deposit {
namespace {

// Arcs are many chords.
double slowDistance(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double x, double y) {
    const auto toSegment = [&](double ax, double ay, double bx, double by) {
        const double length2 = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
        double t = length2 > 0 ? ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length2 : 0;
        t = std::min(1.0, std::max(0.0, t));
        return std::hypot(ax + t * (bx - ax) - x, ay + t * (by - ay) - y);
    };
    if (bead.arc < 0) return toSegment(bead.x0, bead.y0, bead.x1, bead.y1);
    const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    constexpr int kChords = 200;
    double nearest = 1e300;
    double ax = bead.x0;
    double ay = bead.y0;
    const double vx = bead.x0 - arc.center_x;
    const double vy = bead.y0 - arc.center_y;
    for (int n = 1; n <= kChords; ++n) {
        const double turn = arc.sweep * n / kChords;
        const double bx = arc.center_x + vx * std::cos(turn) - vy * std::sin(turn);
        const double by = arc.center_y + vx * std::sin(turn) + vy * std::cos(turn);
        nearest = std::min(nearest, toSegment(ax, ay, bx, by));
        ax = bx;
        ay = by;
    }
    return nearest;
}

struct RandomLayers {
    gcode::Toolpath toolpath;
    std::mt19937 random;

    explicit RandomLayers(unsigned seed) : random(seed) {
        using gcode::Feature;
        toolpath.runs = {{.height = 0.2F, .layer = 1},
                         {.height = 0.2F, .layer = 2},
                         {.height = 0.2F, .layer = 3, .feature = Feature::support},
                         {.height = 0.4F, .layer = 3, .feature = Feature::bridge},
                         {.height = 0.1F, .layer = 4}};
        const double top[] = {0.2, 0.4, 0.55, 0.6, 0.7};
        for (std::uint32_t n = 0; n < 150; ++n) addBead(n / 30, top[n / 30]);
    }

    double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }

    void addBead(std::uint32_t run, double z) {
        gcode::Bead bead{.z0 = z, .z1 = z, .width = static_cast<float>(between(0.3, 0.8)), .run = run, .arc = -1};
        bead.x0 = between(0, 20);
        bead.y0 = between(0, 20);
        const int kind = static_cast<int>(between(0, 6));
        if (kind == 0) {
            const double radius = between(0.5, 6);
            const double angle = between(0, 6);
            gcode::Arc arc{bead.x0 - radius * std::cos(angle), bead.y0 - radius * std::sin(angle), between(-6.2, 6.2)};
            bead.x1 = arc.center_x + radius * std::cos(angle + arc.sweep);
            bead.y1 = arc.center_y + radius * std::sin(angle + arc.sweep);
            bead.arc = static_cast<std::int32_t>(toolpath.arcs.size());
            toolpath.arcs.push_back(arc);
        } else if (kind == 1) {
            bead.x1 = bead.x0;  // a point
            bead.y1 = bead.y0;
        } else if (kind == 2) {
            bead.x1 = bead.x0;  // along y
            bead.y1 = between(0, 20);
        } else {
            bead.x1 = between(0, 20);
            bead.y1 = between(0, 20);
        }
        toolpath.beads.push_back(bead);
    }
};

TEST(BeadSupport, AgreesWithBruteForce) {
    int inside = 0;
    int outside = 0;
    for (unsigned seed = 0; seed < 3; ++seed) {
        const RandomLayers layers(seed);
        const gcode::Toolpath& toolpath = layers.toolpath;
        BeadSupport support(toolpath);
        std::vector<PathPart> parts;
        for (std::uint32_t n = 30; n < toolpath.beads.size(); ++n) {
            const gcode::Bead& upper = toolpath.beads[n];
            support.find(n, parts);
            const BeadPath path(toolpath, upper);
            for (std::size_t k = 0; k < parts.size(); ++k) {
                EXPECT_GE(parts[k].from, k == 0 ? 0 : parts[k - 1].to);
                EXPECT_GE(parts[k].to, parts[k].from);
                EXPECT_LE(parts[k].to, path.length());
            }
            constexpr int kPlaces = 80;
            for (int k = 0; k <= kPlaces; ++k) {
                const double s = k == kPlaces ? path.length() : path.length() * k / kPlaces;
                const PlanPlace place = path.at(s);
                double beyond = 1e300;
                for (const gcode::Bead& lower : toolpath.beads) {
                    if (!support.below(lower, upper)) continue;
                    const double reach = 0.75 * 0.5 * (double{lower.width} + double{upper.width});
                    beyond = std::min(beyond, slowDistance(toolpath, lower, place.x, place.y) - reach);
                }
                if (std::abs(beyond) < 1e-3) continue;  // the chords of the arcs
                const bool found = std::any_of(parts.begin(), parts.end(),
                                               [&](const PathPart& part) { return part.from <= s && s <= part.to; });
                EXPECT_EQ(found, beyond < 0) << "seed " << seed << " bead " << n << " at " << s << " beyond " << beyond;
                ++(found ? inside : outside);
            }
        }
    }
    EXPECT_GT(inside, 2500);
    EXPECT_GT(outside, 2500);
}

TEST(BeadSupport, EndsOfPartsAreAtTheReach) {
    const RandomLayers layers(99);
    const gcode::Toolpath& toolpath = layers.toolpath;
    std::vector<PathPart> parts;
    int ends = 0;
    for (const gcode::Bead& upper : toolpath.beads) {
        for (const gcode::Bead& lower : toolpath.beads) {
            const BeadPath path(toolpath, upper);
            const BeadPath other(toolpath, lower);
            const double reach = BeadSupport::reach(lower, upper);
            parts.clear();
            path.partsNear(other, reach, parts);
            for (const PathPart& part : parts)
                for (const double end : {part.from, part.to}) {
                    const PlanPlace place = path.at(end);
                    if (end == 0 || end == path.length())
                        EXPECT_LE(other.distance(place.x, place.y), reach + 1e-9);
                    else
                        EXPECT_NEAR(other.distance(place.x, place.y), reach, 2e-6);
                    ++ends;
                }
        }
    }
    EXPECT_GT(ends, 1000);
}

TEST(BeadSupport, PlanesDecideWhatIsBelow) {
    using gcode::Feature;
    gcode::Toolpath toolpath;
    toolpath.runs = {{.height = 0.2F, .layer = 2},
                     {.height = 0.4F, .layer = 2, .feature = Feature::bridge},
                     {.height = 0.2F, .layer = 2, .feature = Feature::support_interface}};
    BeadSupport support(toolpath);
    const auto at = [](double z, std::uint32_t run) {
        return gcode::Bead{.z0 = z, .z1 = z, .width = 0.4F, .run = run};
    };
    const gcode::Bead layer = at(1, 0);
    EXPECT_TRUE(support.below(at(0.8, 0), layer));
    EXPECT_TRUE(support.below(at(0.803, 0), layer));  // within what is rounded
    EXPECT_TRUE(support.below(at(0.797, 0), layer));
    EXPECT_FALSE(support.below(at(0.79, 0), layer));
    EXPECT_FALSE(support.below(at(0.6, 0), layer));
    EXPECT_FALSE(support.below(at(1, 0), layer));
    EXPECT_FALSE(support.below(at(1.2, 0), layer));
    // A thick bridge reaches below the top of the layer it lies on; bridges and layers of one level carry nothing.
    const gcode::Bead bridge = at(1, 1);
    EXPECT_TRUE(support.below(at(0.8, 0), bridge));
    EXPECT_TRUE(support.below(at(0.6, 0), bridge));
    EXPECT_FALSE(support.below(at(0.4, 0), bridge));
    EXPECT_FALSE(support.below(at(1, 0), bridge));
    EXPECT_FALSE(support.below(at(1, 1), layer));
    EXPECT_TRUE(support.below(at(0.7, 0), bridge));
    // Support material is left a gap, above and below it; not from itself.
    EXPECT_TRUE(support.below(at(0.6, 2), layer));
    EXPECT_TRUE(support.below(at(0.6, 0), at(1, 2)));
    EXPECT_FALSE(support.below(at(0.6, 2), at(1, 2)));
    EXPECT_FALSE(support.below(at(0.45, 2), layer));
}

TEST(BeadSupport, BedFirstLayerAndIroningCarryAllOfABead) {
    gcode::Toolpath toolpath;
    toolpath.runs = {{.height = 0.2F, .layer = 0},
                     {.height = 0.2F, .layer = 3},
                     {.height = 0.2F, .layer = 4},
                     {.height = 0.02F, .layer = 4, .feature = gcode::Feature::ironing}};
    const auto add = [&](double z, std::uint32_t run) {
        toolpath.beads.push_back({.z0 = z, .x1 = 10, .z1 = z, .width = 0.4F, .run = run, .arc = -1});
    };
    add(5, 0);    // a prime line
    add(5, 1);    // the lowest layer, wherever it is
    add(0.2, 2);  // on the bed
    add(9, 3);
    add(9, 2);
    BeadSupport support(toolpath);
    std::vector<PathPart> parts;
    for (std::uint32_t n = 0; n < 5; ++n) {
        support.find(n, parts);
        ASSERT_EQ(parts.size(), n < 4 ? 1U : 0U);
        if (n == 4) continue;
        EXPECT_EQ(parts[0].from, 0);
        EXPECT_EQ(parts[0].to, 10);
    }
}

TEST(BeadSupport, UnusableBeadsAreNotLevel) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double huge = std::numeric_limits<double>::infinity();
    gcode::Toolpath toolpath;
    toolpath.runs = {{.height = 0.2F, .layer = 1}, {.height = 0, .layer = 2}};
    toolpath.arcs = {{nan, 0, 1}, {0, 0, nan}, {0, 0, 1e30}};
    const gcode::Bead good{.z0 = 1, .x1 = 10, .z1 = 1, .width = 0.4F, .arc = -1};
    std::vector<gcode::Bead> beads(10, good);
    beads[0].x0 = nan;
    beads[1].y1 = huge;
    beads[2].z0 = beads[2].z1 = nan;
    beads[3].width = std::numeric_limits<float>::quiet_NaN();
    beads[4].width = 0;
    beads[5].run = 1;
    for (int n = 6; n < 9; ++n) beads[static_cast<std::size_t>(n)].arc = n - 6;
    beads[9].z1 = 1.1;
    toolpath.beads = beads;
    toolpath.beads.push_back(good);
    const BeadSupport support(toolpath);
    for (std::uint32_t n = 0; n < 10; ++n) EXPECT_FALSE(support.level(n)) << n;
    EXPECT_TRUE(support.level(10));
}

}  // namespace
}  // namespace stratum::deposit
