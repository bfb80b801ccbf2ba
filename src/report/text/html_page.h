// An HTML file that needs no other: the pages of reports and of studies.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stratum::report {

/// Light and dark schemes, wide screens and phones. `title` is text, `body` is HTML, `more_style` is CSS. Tables that
/// may be wide stand in a <div class='scroll'>.
std::string htmlPage(std::string_view title, std::string_view body, std::string_view more_style = {});

// A line plot as SVG text: linear or logarithmic axes, marks, a legend. Nothing but what pages of studies and reports
// need.
//
// Colors of paper, ink and lines can be set by the page, for a dark scheme: the CSS variables --plot-paper, --plot-ink
// and
// --plot-lines; without them a plot is black on white.

struct Series {
    std::string name;
    std::vector<std::pair<double, double>> points;  ///< in the order in which they are joined
    bool dashed = false;
    bool joined = true;
    int color = -1;  ///< index into the palette; -1: the next one
    bool marked = true;
    /// Lowest and highest value at each point, drawn as a bar; empty: none. As many as there are points.
    std::vector<std::pair<double, double>> bars = {};
};

struct Plot {
    std::string title;
    std::string x_label, y_label;  ///< with units
    bool log_x = true, log_y = true;
    std::vector<Series> series;
    bool compact = false;  ///< half as large, so that text is readable on a phone; the legend in a row below
};

/// One <svg> element. Points that an axis can't show (not finite, not positive on a logarithmic axis) are left out; a
/// plot without any other says so.
std::string drawSvg(const Plot& plot);

/// Where an axis over [low, high] gets its labelled ticks, ascending, all within it. A logarithmic axis has them at
/// decades, at 1, 2, 5 or at every digit, whatever gives three or more; over less than that, linear steps.
std::vector<double> axisTicks(double low, double high, bool logarithmic);

/// "<" and its like as HTML and SVG want them.
std::string escapeMarkup(std::string_view text);

}  // namespace stratum::report
