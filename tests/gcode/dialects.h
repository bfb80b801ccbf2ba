// One case of a dialect: a small program, what it must come to, and who says so. docs/gcode.md lists them all.
#pragma once

#include "corpus.h"
#include "gcode/program.h"
#include "gcode/toolpath/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

namespace stratum::gcode {

/// One bead of 1 mm of filament, unless it says otherwise; what else isn't set isn't checked. Places are of the last
/// bead, in mm.
struct Dialect {
    std::string_view name;  ///< letters, digits and underscores
    std::string_view program;
    std::string_view rule;      ///< in plain words
    std::string_view document;  ///< that says so
    std::size_t beads = 1;
    double filament = 1;  ///< mm
    std::optional<Point> start{};
    std::optional<Point> end{};
    std::optional<double> sweep{};   ///< radians, of the last arc
    std::optional<double> volume{};  ///< mm^3, of all
    std::optional<double> height{};
    std::optional<double> speed{};
    std::optional<int> tool{};
    std::optional<std::uint32_t> layer{};
    std::optional<Feature> feature{};
    std::optional<std::string_view> object{};
    std::string_view warning{};  ///< part of one that must come
    bool quiet = false;          ///< no warning at all may come
    Firmware firmware = Firmware::automatic;
};

inline std::ostream& operator<<(std::ostream& out, const Dialect& dialect) { return out << dialect.name; }

/// For INSTANTIATE_TEST_SUITE_P.
inline std::string nameOf(const testing::TestParamInfo<Dialect>& info) { return std::string(info.param.name); }

inline void expectPlace(const Point& expected, double x, double y, double z) {
    EXPECT_NEAR(x, expected.x, 1e-9);
    EXPECT_NEAR(y, expected.y, 1e-9);
    EXPECT_NEAR(z, expected.z, 1e-9);
}

/// Whether the table of cases in docs/gcode.md has a row for it with its source.
inline bool isDocumented(const Dialect& dialect) {
    static const std::string page = [] {
        std::ifstream file(test::sourceDir() / "docs/gcode.md");
        return std::string(std::istreambuf_iterator<char>(file), {});
    }();
    std::string row = "\n| " + std::string(dialect.name) + " | `";
    std::replace(row.begin(), row.end(), '_', ' ');
    const auto at = page.find(row);
    return at != std::string::npos &&
           page.substr(at + 1, page.find('\n', at + 1) - at - 1).ends_with("| " + std::string(dialect.document) + " |");
}

inline void expectDialect(const Dialect& dialect) {
    SCOPED_TRACE(dialect.document);
    EXPECT_TRUE(isDocumented(dialect)) << "docs/gcode.md has no row \"" << dialect.name << "\" with that source";
    ReadOptions options;
    options.firmware = dialect.firmware;
    const Toolpath toolpath = readProgram(dialect.program, options);
    ASSERT_EQ(toolpath.beads.size(), dialect.beads);
    EXPECT_NEAR(toolpath.filament_mm, dialect.filament, 1e-6);
    const Bead& bead = toolpath.beads.back();
    const Run& run = toolpath.runOf(bead);
    if (dialect.start) expectPlace(*dialect.start, bead.x0, bead.y0, bead.z0);
    if (dialect.end) expectPlace(*dialect.end, bead.x1, bead.y1, bead.z1);
    if (dialect.sweep) {
        ASSERT_GE(bead.arc, 0);
        EXPECT_NEAR(toolpath.arcs[static_cast<std::size_t>(bead.arc)].sweep, *dialect.sweep, 1e-9);
    }
    if (dialect.volume) {
        EXPECT_NEAR(beadVolume(toolpath), *dialect.volume, 1e-4 * *dialect.volume);
    }
    if (dialect.height) {
        EXPECT_NEAR(static_cast<double>(run.height), *dialect.height, 1e-4);
    }
    if (dialect.speed) {
        EXPECT_NEAR(static_cast<double>(run.speed), *dialect.speed, 1e-4);
    }
    if (dialect.tool) {
        EXPECT_EQ(run.tool, *dialect.tool);
    }
    if (dialect.layer) {
        EXPECT_EQ(run.layer, *dialect.layer);
    }
    if (dialect.feature) {
        EXPECT_EQ(featureName(run.feature), featureName(*dialect.feature));
    }
    if (dialect.object) {
        EXPECT_EQ(toolpath.objects[run.object], *dialect.object);
    }
    if (!dialect.warning.empty()) {
        EXPECT_GT(warningCount(toolpath, dialect.warning), 0U) << dialect.warning;
    }
    if (dialect.quiet) {
        for (const Warning& warning : toolpath.warnings) ADD_FAILURE() << warning.text;
    }
}

}  // namespace stratum::gcode
