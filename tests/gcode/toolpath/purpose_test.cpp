#include "gcode/toolpath/purpose.h"

#include "gcode/program.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <string>

namespace stratum::gcode {
namespace {

constexpr double kLine = 0.45;
constexpr double kLayer = 0.2;

// Programs without tags, as old slicers write them.
class Program {
public:
    Program() : text_("G21\nG90\nM83\n") {}

    Program& up(double z) {
        text_ += fmt::format("G0 Z{:.3f}\n", z);
        return *this;
    }
    Program& line(double x0, double y0, double x1, double y1) {
        text_ += fmt::format("G0 X{:.3f} Y{:.3f}\n", x0, y0);
        return to(x0, y0, x1, y1);
    }
    Program& loop(double x0, double y0, double x1, double y1) {
        text_ += fmt::format("G0 X{:.3f} Y{:.3f}\n", x0, y0);
        return to(x0, y0, x1, y0).to(x1, y0, x1, y1).to(x1, y1, x0, y1).to(x0, y1, x0, y0);
    }
    // A wall around lines.
    Program& slab(double x0, double y0, double x1, double y1) {
        loop(x0, y0, x1, y1);
        for (double y = y0 + kLine; y < y1; y += kLine) line(x0 + kLine, y, x1 - kLine, y);
        return *this;
    }
    Program& box(double x0, double y0, double x1, double y1, int from, int to) {
        for (int layer = from; layer <= to; ++layer) up(kLayer * layer).slab(x0, y0, x1, y1);
        return *this;
    }
    Program& add(const std::string& text) {
        text_ += text;
        return *this;
    }
    Toolpath read() const { return readProgram(text_); }

private:
    Program& to(double x0, double y0, double x1, double y1) {
        const double e = sectionArea(kLine, kLayer) * std::hypot(x1 - x0, y1 - y0) / kFilamentArea;
        text_ += fmt::format("G1 X{:.3f} Y{:.3f} E{:.6f} F1200\n", x1, y1, e);
        return *this;
    }
    std::string text_;
};

// Length of what is printed for each purpose, mm.
std::array<double, 4> lengths(const Toolpath& toolpath) {
    std::array<double, 4> sums{};
    const std::vector<Purpose> purposes = purposesOf(toolpath);
    for (std::size_t n = 0; n < purposes.size(); ++n)
        sums[static_cast<std::size_t>(purposes[n])] += beadLength(toolpath, toolpath.beads[n]);
    return sums;
}
double brim(const Toolpath& toolpath) { return lengths(toolpath)[2]; }
double beside(const Toolpath& toolpath) { return lengths(toolpath)[3]; }

TEST(Purpose, OfTags) {
    const Toolpath toolpath = Program()
                                  .up(0.2)
                                  .add(";LAYER_CHANGE\n;TYPE:Skirt\n")
                                  .line(0, 0, 1, 0)
                                  .add(";TYPE:Brim\n")
                                  .line(0, 0, 2, 0)
                                  .add(";TYPE:Support material\n")
                                  .line(0, 0, 4, 0)
                                  .add(";TYPE:Wipe tower\n")
                                  .line(0, 0, 8, 0)
                                  .add(";TYPE:External perimeter\n")
                                  .line(0, 0, 16, 0)
                                  .read();
    const auto sums = lengths(toolpath);
    EXPECT_NEAR(sums[static_cast<std::size_t>(Purpose::beside)], 9, 1e-6);
    EXPECT_NEAR(sums[static_cast<std::size_t>(Purpose::brim)], 2, 1e-6);
    EXPECT_NEAR(sums[static_cast<std::size_t>(Purpose::support)], 4, 1e-6);
    EXPECT_NEAR(sums[static_cast<std::size_t>(Purpose::part)], 16, 1e-6);
}

TEST(Purpose, ALoopAroundThePartIsASkirt) {
    const Toolpath toolpath =
        Program().up(0.2).loop(-5, -5, 25, 25).loop(-5.4, -5.4, 25.4, 25.4).box(0, 0, 20, 20, 1, 8).read();
    EXPECT_NEAR(beside(toolpath), 4 * 30 + 4 * 30.8, 0.01);
    // And on two layers.
    const Toolpath high = Program()
                              .up(0.2)
                              .loop(-5, -5, 25, 25)
                              .box(0, 0, 20, 20, 1, 1)
                              .up(0.4)
                              .loop(-5, -5, 25, 25)
                              .box(0, 0, 20, 20, 2, 8)
                              .read();
    EXPECT_NEAR(beside(high), 240, 0.01);
}

TEST(Purpose, LinesBesideThePartArePrimeLines) {
    const Toolpath toolpath =
        Program().up(0.3).line(-20, 0, -20, 100).line(-19.6, 100, -19.6, 0).up(0.2).box(0, 0, 20, 20, 1, 8).read();
    EXPECT_NEAR(beside(toolpath), 200, 0.01);
}

// A part whose first layer is a wave, from the bed up: the prime lines before it are not at its lowest place.
TEST(Purpose, PrimeLinesMayLieAboveAWavyFirstLayer) {
    const auto wave = [](bool first) {
        Program program;
        if (first) program.up(0.3).line(-20, 0, -20, 100).line(-19.6, 100, -19.6, 0);
        for (int layer = 1; layer <= 8; ++layer)
            for (double x = 0; x < 20; x += kLine)
                program.up(kLayer * layer - 0.15 + 0.1 * std::sin(x)).line(x, 0, x, 20);
        if (!first) program.up(0.3).line(-20, 0, -20, 100).line(-19.6, 100, -19.6, 0);
        return program.read();
    };
    EXPECT_NEAR(beside(wave(true)), 200, 0.01);
    EXPECT_EQ(beside(wave(false)), 0);  // nobody primes at the end
}

// A move to the part that extrudes a little does not make prime lines a piece of it.
TEST(Purpose, AThreadJoinsNothing) {
    const Toolpath toolpath = Program()
                                  .up(0.2)
                                  .line(-20, 0, -20, 100)
                                  .line(-19.6, 100, -19.6, 0)
                                  .add("G1 X0 Y0 E0.01\n")
                                  .box(0, 0, 20, 20, 1, 8)
                                  .read();
    EXPECT_NEAR(beside(toolpath), 219.6, 0.01);
}

TEST(Purpose, OnePlateOfFlatAndTallPartsIsAllPart) {
    // A flat one, and one of a single layer, which is no line; a ring beside them.
    const Toolpath toolpath = Program().up(0.2).slab(40, 0, 60, 20).slab(40, 40, 60, 45).box(0, 0, 20, 20, 1, 8).read();
    EXPECT_EQ(beside(toolpath), 0);
    EXPECT_EQ(brim(toolpath), 0);
}

TEST(Purpose, AFlatPrintIsAllPart) {
    const Toolpath toolpath = Program().up(0.2).loop(-5, -5, 25, 25).box(0, 0, 20, 20, 1, 2).read();
    EXPECT_EQ(beside(toolpath), 0);
}

TEST(Purpose, LoopsThatGrowFromTheFirstLayerAreABrim) {
    Program program;
    program.up(0.2);
    double length = 0;
    for (int n = 8; n >= 1; --n) {
        program.loop(-kLine * n, -kLine * n, 20 + kLine * n, 20 + kLine * n);
        length += 4 * (20 + 2 * kLine * n);
    }
    const Toolpath toolpath = program.box(0, 0, 20, 20, 1, 8).read();
    // The loop at the wall may count as either.
    EXPECT_NEAR(brim(toolpath), length, 4 * (20 + 4 * kLine) + 4 * (20 + 2 * kLine));
    EXPECT_GT(brim(toolpath), 0.7 * length);
}

TEST(Purpose, AFootThatThePartStandsOnIsNoBrim) {
    const Toolpath toolpath = Program().up(0.2).slab(-8, -8, 28, 28).box(0, 0, 20, 20, 2, 8).read();
    EXPECT_EQ(brim(toolpath), 0);
    // A chamfer neither.
    const Toolpath chamfer = Program().up(0.2).slab(-0.6, -0.6, 20.6, 20.6).box(0, 0, 20, 20, 2, 8).read();
    EXPECT_EQ(brim(chamfer), 0);
}

// Sixteen kilometres of lines near the bed are in no print: a damaged file.
TEST(Purpose, LinesWithoutEndAreLeftAlone) {
    std::string text = "M83\nG1 Z0.2\n";
    for (int n = 0; n < 160; ++n) text += fmt::format("G0 X-50000 Y{}\nG1 X50000 E90\n", n * 30);
    const auto start = std::chrono::steady_clock::now();
    for (const Purpose purpose : purposesOf(readProgram(text))) EXPECT_EQ(purpose, Purpose::part);
    EXPECT_LT(std::chrono::steady_clock::now() - start,
              std::chrono::seconds(20));  // 6 minutes before there was a bound
}

TEST(Purpose, PartsPrintedOneAfterAnother) {
    const Toolpath toolpath =
        Program().up(0.2).loop(-5, -5, 85, 25).box(0, 0, 20, 20, 1, 8).up(5).box(60, 0, 80, 20, 1, 8).read();
    EXPECT_NEAR(beside(toolpath), 2 * (90 + 30), 0.01);
}

TEST(Purpose, OfNothing) { EXPECT_TRUE(purposesOf(Toolpath{}).empty()); }

TEST(Purpose, BeadsOfThePart) {
    const Toolpath toolpath = Program().up(0.2).loop(-5, -5, 25, 25).box(0, 0, 20, 20, 1, 8).read();
    std::vector<std::uint32_t> all(toolpath.beads.size());
    std::iota(all.begin(), all.end(), 0U);
    const auto beads = beadsUpTo(Purpose::part, purposesOf(toolpath), all);
    EXPECT_EQ(beads.size(), all.size() - 4);
    EXPECT_EQ(beads.front(), 4U);
    // Of a selection that has none, all.
    EXPECT_EQ(beadsUpTo(Purpose::part, purposesOf(toolpath), std::span(all).first(4)).size(), 4U);
}

}  // namespace
}  // namespace stratum::gcode
