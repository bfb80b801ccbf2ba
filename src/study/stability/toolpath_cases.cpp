// Moves that nobody slices and everybody gets one day.
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::study {
namespace {

using Make = std::function<gcode::Toolpath()>;

StabilityCase field(std::string name, const Make& make, double voxel = 0.05, double height = kBeadHeight) {
    const voxelize::Lattice lattice = plainLattice(voxel, height);
    return {"toolpath",
            std::move(name),
            "largest error of the distance, mm",
            fieldTolerance(make(), lattice),
            kRoundings,
            [=] { return largestFieldError(make(), lattice); }};
}

gcode::Toolpath lines(int count, const std::function<void(gcode::Toolpath&, int)>& add) {
    gcode::Toolpath toolpath;
    for (int n = 0; n < count; ++n) add(toolpath, n);
    return toolpath;
}

gcode::Toolpath one(double x0, double y0, double z0, double x1, double y1, double z1, double width = kBeadWidth,
                    double height = kBeadHeight) {
    gcode::Toolpath toolpath;
    addBead(toolpath, x0, y0, z0, x1, y1, z1, width, height);
    return toolpath;
}

// Two ways to print the same thing must give the same grid.
StabilityCase twins(std::string name, const Make& a, const Make& b, double tolerance, std::string why) {
    return {"toolpath", std::move(name), "largest difference from its twin, mm", tolerance, std::move(why), [=] {
                openvdb::initialize();
                const gcode::Toolpath first = a();
                const gcode::Toolpath second = b();
                const voxelize::Lattice lattice = plainLattice(0.05, kBeadHeight);
                return largestDifference(*voxelize::voxelize(first, allBeads(first), lattice),
                                         *voxelize::voxelize(second, allBeads(second), lattice));
            }};
}

gcode::Toolpath spiral(double climb) {
    return lines(120, [=](gcode::Toolpath& t, int n) {
        const double step = 2 * std::numbers::pi / 40;
        addBead(t, 2 * std::cos(n * step), 2 * std::sin(n * step), kBeadHeight + climb * n / 40,
                2 * std::cos((n + 1) * step), 2 * std::sin((n + 1) * step), kBeadHeight + climb * (n + 1) / 40,
                kBeadWidth, kBeadHeight);
    });
}

// Of what is on the plane between two layers whose planes miss each other by `gap` (mm), the most positive, mm.
double crackBetweenLayers(double gap) {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    addBead(toolpath, -2, 0, kBeadHeight, 2, 0, kBeadHeight, kBeadWidth, kBeadHeight, 1);
    addBead(toolpath, -2, 0, 2 * kBeadHeight + gap, 2, 0, 2 * kBeadHeight + gap, kBeadWidth, kBeadHeight, 2);
    const auto grid = voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(0.05, kBeadHeight));
    const auto accessor = grid->getConstAccessor();
    double largest = -1;
    for (int i = -30; i <= 30; ++i)
        largest = std::max(largest, static_cast<double>(accessor.getValue(openvdb::Coord(i, 0, 4))));
    return largest;
}

void addMoves(std::vector<StabilityCase>& cases) {
    cases.push_back(field("zero-length move", [] { return one(1, 1, kBeadHeight, 1, 1, kBeadHeight); }));
    cases.push_back(field("move of a picometre", [] { return one(1, 1, kBeadHeight, 1 + 1e-12, 1, kBeadHeight); }));
    cases.push_back(field("hairpin, a micrometre wide", [] {
        return lines(2, [](gcode::Toolpath& t, int n) {
            addBead(t, n == 0 ? 0 : 3, n == 0 ? 0 : 1e-3, kBeadHeight, n == 0 ? 3 : 0, n == 0 ? 1e-3 : 2e-3,
                    kBeadHeight, kBeadWidth, kBeadHeight);
        });
    }));
    cases.push_back(field("forth and back on one line", [] {
        return lines(2, [](gcode::Toolpath& t, int n) {
            addBead(t, n == 0 ? 0 : 3, 0, kBeadHeight, n == 0 ? 3 : 0, 0, kBeadHeight, kBeadWidth, kBeadHeight);
        });
    }));
    cases.push_back(field("crossing at a microradian", [] {
        return lines(2, [](gcode::Toolpath& t, int n) {
            addBead(t, -2, n * 2e-6, kBeadHeight, 2, n * -2e-6, kBeadHeight, kBeadWidth, kBeadHeight);
        });
    }));
    cases.push_back(field(
        "one bead of a metre", [] { return one(-300, -400, kBeadHeight, 300, 400, kBeadHeight); }, 0.1));
    cases.push_back(
        field("1 m from the origin", [] { return crossedLines(kBeadWidth, kBeadHeight, 1000, 1000, 1000); }));
    cases.push_back(
        field("1 m on the other side", [] { return crossedLines(kBeadWidth, kBeadHeight, -1000, -1000, 0); }));
    cases.push_back(
        field("10 m from the origin", [] { return crossedLines(kBeadWidth, kBeadHeight, 1e4, -1e4, 100); }));
    cases.push_back(twins(
        "1000 segments of 1 \u00b5m",
        [] {
            return lines(1000, [](gcode::Toolpath& t, int n) {
                addBead(t, n * 1e-3, 0, kBeadHeight, (n + 1) * 1e-3, 0, kBeadHeight, kBeadWidth, kBeadHeight);
            });
        },
        [] { return one(0, 0, kBeadHeight, 1, 0, kBeadHeight); }, 2 * 8 * 0x1p-24 * 0.4,
        "two fields of 8 float roundings each of a leaf's 0.4 mm"));
    cases.push_back(twins(
        "a bead laid 1000 times",
        [] {
            return lines(1000, [](gcode::Toolpath& t, int) {
                addBead(t, 0, 0, kBeadHeight, 3, 1, kBeadHeight, kBeadWidth, kBeadHeight);
            });
        },
        [] { return one(0, 0, kBeadHeight, 3, 1, kBeadHeight); }, 0, "the minimum of equal numbers is that number"));
    const Make ordered = [] { return crossedLines(kBeadWidth, kBeadHeight); };
    const Make reversed = [] {
        gcode::Toolpath toolpath = crossedLines(kBeadWidth, kBeadHeight);
        std::reverse(toolpath.beads.begin(), toolpath.beads.end());
        return toolpath;
    };
    cases.push_back(twins("layers out of order", ordered, reversed, 0, "a minimum does not depend on the order"));
}

void addSections(std::vector<StabilityCase>& cases) {
    cases.push_back(field("width 0", [] { return one(0, 0, kBeadHeight, 2, 1, kBeadHeight, 0); }));
    cases.push_back(field(
        "width of a thousandth of the height",
        [] { return one(0, 0, kBeadHeight, 2, 1, kBeadHeight, 1e-3 * kBeadHeight); }, 0.02));
    cases.push_back(field("as wide as high", [] { return crossedLines(kBeadHeight, kBeadHeight); }));
    cases.push_back(field("a hair wider than high", [] { return crossedLines(kBeadHeight * 1.0001, kBeadHeight); }));
    cases.push_back(field(
        "100 times as wide as high", [] { return crossedLines(100 * kBeadHeight, kBeadHeight); }, 0.1));
    cases.push_back(field(
        "layers of 10 \u00b5m", [] { return crossedLines(0.02, 0.01); }, 0.0025, 0.01));
    cases.push_back(field(
        "layers of 5 mm", [] { return crossedLines(10, 5); }, 1.25, 5));
    cases.push_back(field("a thin and a thick layer at one place", [] {
        gcode::Toolpath toolpath = crossedLines(0.5, kBeadHeight);
        addBead(toolpath, 0.2, 0, 1.5, 1, 0.1, 1.5, 2.0, 1.5, 9);
        addBead(toolpath, -1, 0, 0.05, 1, 0, 0.05, 0.3, 0.05, 9);
        return toolpath;
    }));
    for (const double gap : {1e-9, 1e-4, 2e-3})
        cases.push_back({"toolpath", fmt::format("layers that miss each other by {:g} mm", gap),
                         "largest value on the plane between, mm", 0,
                         "gaps of up to 2 % of a layer are welded: inside is not positive",
                         [gap] { return crackBetweenLayers(gap); }});
}

void addCurves(std::vector<StabilityCase>& cases) {
    constexpr double kTurn = 2 * std::numbers::pi;
    const auto arc = [](double radius, double from, double sweep) {
        return [=] {
            gcode::Toolpath toolpath;
            // About a centre that keeps the path near the origin.
            addArc(toolpath, -radius * std::cos(from), -radius * std::sin(from), radius, from, sweep, kBeadHeight,
                   kBeadHeight, kBeadWidth, kBeadHeight);
            return toolpath;
        };
    };
    cases.push_back(field("full circle", arc(2, 0.3, kTurn)));
    cases.push_back(field("circle of 1 \u00b5m", arc(1e-3, 0.3, kTurn)));
    cases.push_back(field("circle narrower than its bead", arc(0.1, 0.3, -kTurn)));
    cases.push_back(field("arc of 100 m radius, 2 mm long", arc(1e5, 0.7, 2e-5)));
    cases.push_back(field("arc that turns a nanoradian", arc(2, 0.7, 1e-9)));
    cases.push_back(field("spiral of one layer a turn", [] { return spiral(kBeadHeight); }));
    cases.push_back(field("spiral of ten layers a turn", [] { return spiral(10 * kBeadHeight); }));
    cases.push_back(field("straight up", [] { return one(0, 0, kBeadHeight, 0, 0, 3); }));
    cases.push_back(
        field("slope of a microradian", [] { return one(-2, 0, kBeadHeight, 2, 0.3, kBeadHeight + 4e-6); }));
}

}  // namespace

std::vector<StabilityCase> toolpathCases() {
    std::vector<StabilityCase> cases;
    addMoves(cases);
    addSections(cases);
    addCurves(cases);
    return cases;
}

}  // namespace stratum::study
