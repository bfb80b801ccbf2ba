#include "report/text/html_page.h"

#include <gtest/gtest.h>

#include <cmath>

namespace stratum::report {
namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

TEST(SvgPlot, TicksOfLogarithmicAxes) {
    EXPECT_EQ(axisTicks(0.5, 2000, true), (std::vector<double>{1, 10, 100, 1000}));
    const std::vector<double> close = axisTicks(0.09, 0.6, true);
    ASSERT_EQ(close.size(), 3U);
    EXPECT_NEAR(close[0], 0.1, 1e-12);
    EXPECT_NEAR(close[2], 0.5, 1e-12);
    for (const double low : {1e-9, 0.07, 1.0, 1.5e8})
        for (const double ratio : {1.05, 1.5, 3.0, 40.0, 1e6}) {
            const auto ticks = axisTicks(low, low * ratio, true);
            EXPECT_GE(ticks.size(), 3U) << low << " " << ratio;
            EXPECT_LE(ticks.size(), 20U);
            for (const double tick : ticks) EXPECT_TRUE(tick >= low && tick <= low * ratio * (1 + 1e-12));
        }
}

TEST(SvgPlot, TicksOfLinearAxes) {
    const auto ticks = axisTicks(-1, 1, false);
    EXPECT_EQ(ticks.size(), 5U);
    EXPECT_NEAR(ticks.front(), -1, 1e-12);
}

TEST(SvgPlot, DrawsEachPointThatTheAxesCanShow) {
    Plot plot{"a < b", "x, mm", "y", true, true, {{"one", {{1, 1}, {10, 100}, {0, 5}, {2, std::nan("")}}}}};
    const std::string svg = drawSvg(plot);
    EXPECT_EQ(countOf(svg, "<circle"), 3U);  // two, and one in the legend
    EXPECT_EQ(countOf(svg, "a &lt; b"), 1U);
    EXPECT_EQ(countOf(svg, "nan"), 0U);
    EXPECT_EQ(countOf(svg, "<svg"), countOf(svg, "</svg>"));
    plot.log_x = plot.log_y = false;
    EXPECT_EQ(countOf(drawSvg(plot), "<circle"), 4U);
}

TEST(SvgPlot, PutsDecadesAtEqualDistances) {
    const Plot plot{"", "", "", true, true, {{"s", {{1, 1}, {10, 1}, {100, 2}}}}};
    const std::string svg = drawSvg(plot);
    std::vector<double> at;
    for (std::size_t n = svg.find("cx='"); n != std::string::npos; n = svg.find("cx='", n + 1))
        at.push_back(std::stod(svg.substr(n + 4)));
    ASSERT_GE(at.size(), 3U);
    EXPECT_NEAR(at[1] - at[0], at[2] - at[1], 0.11);
}

// A bar from the lowest to the highest value, which the axis has room for; what a logarithmic axis can't show of it
// ends at the frame.
TEST(SvgPlot, DrawsBarsOfErrors) {
    Plot plot{"t", "x", "y", false, true, {{"one", {{1, 10}, {2, 20}}}}};
    const std::string bare = drawSvg(plot);
    plot.series[0].bars = {{5, 1000}, {-3, 40}};
    const std::string svg = drawSvg(plot);
    EXPECT_EQ(countOf(bare, "h6"), 0U);
    EXPECT_EQ(countOf(svg, "h6M"), 2U);
    EXPECT_NE(svg.find(">1000<"), std::string::npos);
    EXPECT_EQ(bare.find(">1000<"), std::string::npos);
    EXPECT_NE(svg.find(" 384.0V"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(SvgPlot, SaysWhenThereIsNothing) { EXPECT_NE(drawSvg(Plot{}).find("no points"), std::string::npos); }

}  // namespace
}  // namespace stratum::report
