#include "deposit/bead_support.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

namespace stratum::deposit {
namespace {

struct Nearest {
    double distance = 1e300;  // mm
    gcode::PlanPoint place;
};

// Arcs are many chords.
Nearest slowNearest(const gcode::Toolpath& toolpath, const gcode::Bead& bead, gcode::PlanPoint from) {
    Nearest nearest;
    const auto toSegment = [&](double ax, double ay, double bx, double by) {
        const double length2 = (bx - ax) * (bx - ax) + (by - ay) * (by - ay);
        double t = length2 > 0 ? ((from.x - ax) * (bx - ax) + (from.y - ay) * (by - ay)) / length2 : 0;
        t = std::min(1.0, std::max(0.0, t));
        const gcode::PlanPoint place{ax + t * (bx - ax), ay + t * (by - ay)};
        const double distance = std::hypot(place.x - from.x, place.y - from.y);
        if (distance < nearest.distance) nearest = {distance, place};
    };
    double ax = bead.x0;
    double ay = bead.y0;
    if (bead.arc < 0) {
        toSegment(ax, ay, bead.x1, bead.y1);
        return nearest;
    }
    const gcode::Arc& arc = toolpath.arcs[static_cast<std::size_t>(bead.arc)];
    constexpr int kChords = 200;
    const double vx = bead.x0 - arc.center_x;
    const double vy = bead.y0 - arc.center_y;
    for (int n = 1; n <= kChords; ++n) {
        const double turn = arc.sweep * n / kChords;
        const double bx = arc.center_x + vx * std::cos(turn) - vy * std::sin(turn);
        const double by = arc.center_y + vx * std::sin(turn) + vy * std::cos(turn);
        toSegment(ax, ay, bx, by);
        ax = bx;
        ay = by;
    }
    return nearest;
}

// How far a place of `upper` is beyond the reach of what is below, mm.
double slowBeyondBelow(const gcode::Toolpath& toolpath, const BeadSupport& support, const gcode::Bead& upper,
                       gcode::PlanPoint place) {
    if (toolpath.runOf(upper).layer == 1) return -1;
    double beyond = 1e300;
    for (const gcode::Bead& lower : toolpath.beads) {
        if (!support.below(lower, upper)) continue;
        const double reach = 0.75 * 0.5 * (double{lower.width} + double{upper.width});
        beyond = std::min(beyond, slowNearest(toolpath, lower, place).distance - reach);
    }
    return beyond;
}

// Below 0: a neighbour holds the place of bead n at s; above it, what is missing for the nearest to that. `arcs` tells
// whether an arc was near.
double slowBeyondBeside(const gcode::Toolpath& toolpath, const BeadSupport& support, std::uint32_t n, double s,
                        bool& arcs) {
    const gcode::Bead& bead = toolpath.beads[n];
    const gcode::PlanPath path(toolpath, bead);
    const gcode::PlanPoint place = path.at(s);
    const gcode::PlanPoint before = path.at(s - 1e-5);
    const gcode::PlanPoint after = path.at(s + 1e-5);
    const double step = std::hypot(after.x - before.x, after.y - before.y);
    double beyond = 1e300;
    for (std::uint32_t k = 0; k < toolpath.beads.size(); ++k) {
        const gcode::Bead& neighbour = toolpath.beads[k];
        if (k == n || !support.holds(neighbour, bead)) continue;
        const Nearest nearest = slowNearest(toolpath, neighbour, place);
        double missing = nearest.distance - 1.15 * 0.5 * (double{neighbour.width} + double{bead.width});
        if (missing > 0.1) continue;
        arcs = arcs || neighbour.arc >= 0;
        if (step > 0) {
            const double dx = nearest.place.x - place.x;
            const double dy = nearest.place.y - place.y;
            const double along = std::abs(dx * (after.x - before.x) + dy * (after.y - before.y)) / step;
            const double across = std::abs(dx * (after.y - before.y) - dy * (after.x - before.x)) / step;
            missing = std::max(missing, along - across);
        }
        missing = std::max(missing, slowBeyondBelow(toolpath, support, neighbour, nearest.place));
        beyond = std::min(beyond, missing);
    }
    return beyond;
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
        } else if (kind <= 4 && toolpath.beads.size() % 30 > 0) {
            const gcode::Bead& last = toolpath.beads.back();  // beside it, about
            const double side = between(0.2, 0.7);
            bead.x0 = last.x0 + side;
            bead.y0 = last.y0 + between(-0.4, 0.4);
            bead.x1 = last.x1 + side;
            bead.y1 = last.y1 + between(-0.4, 0.4);
        } else {
            bead.x1 = between(0, 20);
            bead.y1 = between(0, 20);
        }
        toolpath.beads.push_back(bead);
    }
};

bool isIn(const std::vector<PathPart>& parts, double s) {
    return std::any_of(parts.begin(), parts.end(),
                       [&](const PathPart& part) { return part.from <= s && s <= part.to; });
}

void expectApart(const std::vector<PathPart>& parts, double length) {
    for (std::size_t k = 0; k < parts.size(); ++k) {
        EXPECT_GE(parts[k].from, k == 0 ? 0 : parts[k - 1].to);
        EXPECT_GE(parts[k].to, parts[k].from);
        EXPECT_LE(parts[k].to, length);
    }
}

TEST(BeadSupport, AgreesWithBruteForce) {
    int inside = 0;
    int outside = 0;
    int beside = 0;
    for (unsigned seed = 0; seed < 3; ++seed) {
        const RandomLayers layers(seed);
        const gcode::Toolpath& toolpath = layers.toolpath;
        const BeadSupport support(toolpath);
        BeadSupport::Search search;
        std::vector<PathPart> below;
        std::vector<PathPart> all;
        for (std::uint32_t n = 30; n < toolpath.beads.size(); ++n) {
            const gcode::Bead& upper = toolpath.beads[n];
            support.find(n, all, search);
            support.fromBelow(n, below);
            const gcode::PlanPath path(toolpath, upper);
            expectApart(below, path.length());
            expectApart(all, path.length());
            constexpr int kPlaces = 40;
            for (int k = 0; k <= kPlaces; ++k) {
                const double s = k == kPlaces ? path.length() : path.length() * k / kPlaces;
                const double beyond = slowBeyondBelow(toolpath, support, upper, path.at(s));
                if (std::abs(beyond) < 1e-3) continue;  // the chords of the arcs
                const bool found = isIn(below, s);
                EXPECT_EQ(found, beyond < 0) << "seed " << seed << " bead " << n << " at " << s << " beyond " << beyond;
                ++(found ? inside : outside);
                bool arcs = upper.arc >= 0;
                const double missing = slowBeyondBeside(toolpath, support, n, s, arcs);
                // Short parts of arcs may be missed.
                if (std::abs(missing) < (arcs ? 0.06 : 1e-3)) continue;
                EXPECT_EQ(isIn(all, s), found || missing < 0)
                    << "seed " << seed << " bead " << n << " at " << s << " missing " << missing;
                if (!found && missing < 0) ++beside;
            }
        }
    }
    EXPECT_GT(inside, 2500);
    EXPECT_GT(outside, 2500);
    EXPECT_GT(beside, 100);
}

TEST(BeadSupport, EndsOfPartsAreAtTheReach) {
    const RandomLayers layers(99);
    const gcode::Toolpath& toolpath = layers.toolpath;
    std::vector<PathPart> parts;
    int ends = 0;
    for (const gcode::Bead& upper : toolpath.beads) {
        for (const gcode::Bead& lower : toolpath.beads) {
            const gcode::PlanPath path(toolpath, upper);
            const gcode::PlanPath other(toolpath, lower);
            const double reach = BeadSupport::reach(lower, upper);
            parts.clear();
            partsNear(path, other, reach, parts);
            for (const PathPart& part : parts)
                for (const double end : {part.from, part.to}) {
                    const gcode::PlanPoint place = path.at(end);
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

// A wall along x on the bed, and beads of 0.4 mm of the layer above, from x = 0 to 10 unless told.
struct Overhang {
    gcode::Toolpath toolpath;

    explicit Overhang(double wall_end = 11) {
        toolpath.runs = {{.height = 0.2F, .layer = 1}, {.height = 0.2F, .layer = 2}};
        toolpath.beads.push_back({.x0 = -1, .z0 = 0.2, .x1 = wall_end, .z1 = 0.2, .width = 0.4F, .arc = -1});
    }
    std::uint32_t add(double y, double x0 = 0, double x1 = 10) {
        toolpath.beads.push_back(
            {.x0 = x0, .y0 = y, .z0 = 0.4, .x1 = x1, .y1 = y, .z1 = 0.4, .width = 0.4F, .run = 1, .arc = -1});
        return static_cast<std::uint32_t>(toolpath.beads.size() - 1);
    }
    // mm
    double supported(std::uint32_t bead) const {
        const BeadSupport support(toolpath);
        BeadSupport::Search search;
        std::vector<PathPart> parts;
        support.find(bead, parts, search);
        double length = 0;
        for (const PathPart& part : parts) length += part.to - part.from;
        return length;
    }
};

TEST(BeadSupport, LineBesideASupportedOneIsHeld) {
    for (const bool inner_first : {true, false}) {
        Overhang overhang;
        std::uint32_t inner = inner_first ? overhang.add(0.25) : 0;
        const std::uint32_t outer = overhang.add(0.65, 10, 0);
        const std::uint32_t outermost = overhang.add(1.05);
        if (!inner_first) inner = overhang.add(0.25);
        EXPECT_EQ(overhang.supported(inner), 10);
        EXPECT_EQ(overhang.supported(outer), 10);
        EXPECT_EQ(overhang.supported(outermost), 0);  // one bead far
    }
    Overhang apart;
    apart.add(0.25);
    EXPECT_EQ(apart.supported(apart.add(0.72)), 0);
    EXPECT_EQ(apart.supported(apart.add(0.70)), 10);
    // Where the neighbour is supported itself.
    Overhang half(5);
    half.add(0);
    EXPECT_NEAR(half.supported(half.add(0.4)), 5 + 0.75 * double{0.4F}, 1e-6);
}

TEST(BeadSupport, TopsDecideWhatIsBeside) {
    for (int kind = 0; kind < 4; ++kind) {
        Overhang overhang;
        overhang.toolpath.runs.push_back(overhang.toolpath.runs.back());
        overhang.add(0.25);
        const std::uint32_t outer = overhang.add(0.65);
        gcode::Run& run = overhang.toolpath.runs.back();
        gcode::Bead& bead = overhang.toolpath.beads.back();
        bead.run = 2;
        if (kind == 1) run.height = 0.3F;  // an overhanging perimeter is thick
        if (kind == 2) bead.z0 = bead.z1 = 0.41;
        if (kind == 3) overhang.toolpath.runs[1].feature = gcode::Feature::ironing;
        EXPECT_EQ(overhang.supported(outer), kind < 2 ? 10 : 0) << kind;
    }
}

TEST(BeadSupport, JointsAndCrossingsHoldNoMore) {
    const double held = 4 + 0.75 * double{0.4F};
    Overhang whole(4);
    EXPECT_NEAR(whole.supported(whole.add(0)), held, 1e-9);
    // The same bead in pieces; joints at the edge and next to it.
    for (const double joint : {3.9, 4.0, 4.2, held}) {
        Overhang pieces(4);
        const std::uint32_t first = pieces.add(0, 0, joint);
        const std::uint32_t second = pieces.add(0, joint, joint + 0.02);
        const std::uint32_t third = pieces.add(0, joint + 0.02, 10);
        EXPECT_NEAR(pieces.supported(first) + pieces.supported(second) + pieces.supported(third), held, 1e-6);
    }
    for (const bool crossing : {false, true}) {
        Overhang square;
        square.add(0.2);
        gcode::Bead bead = square.toolpath.beads.back();
        bead.x0 = bead.x1 = 5;
        bead.y0 = crossing ? -4 : 0.2;
        bead.y1 = 4;
        square.toolpath.beads.push_back(bead);
        EXPECT_NEAR(square.supported(2), crossing ? 0.6 : 0.1, 1e-6);
    }
}

// `count` beads across a long one in each of 50 cells of the grid, and that one above them.
gcode::Toolpath piledUnderOne(int count) {
    gcode::Toolpath toolpath;
    toolpath.runs = {{.height = 0.2F, .layer = 1}, {.height = 0.2F, .layer = 2}};
    for (int cell = 0; cell < 50; ++cell)
        for (int n = 0; n < count; ++n)
            toolpath.beads.push_back(
                {.x0 = 1 + 2.0 * cell, .z0 = 0.2, .x1 = 1 + 2.0 * cell, .y1 = 1, .z1 = 0.2, .width = 0.4F, .arc = -1});
    toolpath.beads.push_back({.y0 = 0.5, .z0 = 0.4, .x1 = 100, .y1 = 0.5, .z1 = 0.4, .width = 0.4F, .run = 1});
    toolpath.beads.back().arc = -1;
    return toolpath;
}

TEST(BeadSupport, PilesCarryEverywhere) {
    for (const int count : {110, 130, 2100}) {
        const gcode::Toolpath toolpath = piledUnderOne(count);
        const BeadSupport support(toolpath);
        BeadSupport::Search search;
        std::vector<PathPart> parts;
        support.find(static_cast<std::uint32_t>(toolpath.beads.size() - 1), parts, search);
        EXPECT_EQ(parts.size(), count == 110 ? 50U : 1U);
        EXPECT_EQ(parts.back().to, count == 110 ? parts.back().to : 100);
    }
}

TEST(BeadSupport, PilesTakeLittleTime) {
    constexpr int kCount = 20000;
    for (const double y_step : {0.0, 0.001, 0.02}) {  // all in one place; in sheets, the last within the bounds
        gcode::Toolpath toolpath;
        toolpath.runs = {{.height = 0.2F, .layer = 1}, {.height = 0.2F, .layer = 2}};
        for (std::uint32_t layer = 0; layer < 2; ++layer)
            for (int n = 0; n < kCount; ++n) {
                const double z = 0.2 * (layer + 1);
                const double y = y_step * n;
                const double x0 = layer == 0 ? 0.5 : 0;  // never all of the bead above it
                toolpath.beads.push_back(
                    {.x0 = x0, .y0 = y, .z0 = z, .x1 = 5, .y1 = y, .z1 = z, .width = 0.2F, .run = layer, .arc = -1});
            }
        const auto start = std::chrono::steady_clock::now();
        const BeadSupport support(toolpath);
        BeadSupport::Search search;
        std::vector<PathPart> parts;
        for (std::uint32_t n = kCount; n < 2 * kCount; ++n) support.find(n, parts, search);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        RecordProperty("seconds", std::to_string(seconds.count()));
        EXPECT_LT(seconds.count(), 20);  // a sanitizer's build
    }
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
    const BeadSupport support(toolpath);
    BeadSupport::Search search;
    std::vector<PathPart> parts;
    for (std::uint32_t n = 0; n < 5; ++n) {
        support.find(n, parts, search);
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
