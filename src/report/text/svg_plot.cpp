#include "report/text/html_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace stratum::report {
namespace {

// Pixels.
struct Frame {
    double width, height, left, right, top, bottom;
};
constexpr Frame kLarge{860, 440, 84, 640, 36, 384};
constexpr Frame kCompact{430, 290, 66, 416, 36, 226};

// Distinct also to those who see no red or no green. Source: M. Okabe, K. Ito, "Color Universal Design", 2008.
constexpr std::array<const char*, 8> kPalette{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#000000", "#9a9a00"};

class Axis {
public:
    Axis(bool logarithmic, double from, double to) : logarithmic_(logarithmic), from_(from), to_(to) {}

    bool shows(double v) const { return std::isfinite(v) && (!logarithmic_ || v > 0); }
    void include(double v) {
        low_ = std::min(low_, v);
        high_ = std::max(high_, v);
    }
    bool empty() const { return low_ > high_; }
    // A little air, so that no mark lies on the frame.
    void settle() {
        if (logarithmic_) {
            const double air = std::max(std::pow(high_ / low_, 0.06), 1.05);
            low_ /= air;
            high_ *= air;
        } else {
            const double air = high_ > low_ ? 0.06 * (high_ - low_) : std::max(std::abs(high_) * 0.1, 1e-12);
            low_ -= air;
            high_ += air;
        }
    }
    double pixel(double v) const {
        const double t = logarithmic_ ? std::log(v / low_) / std::log(high_ / low_) : (v - low_) / (high_ - low_);
        return from_ + t * (to_ - from_);
    }
    std::vector<double> ticks() const { return axisTicks(low_, high_, logarithmic_); }

private:
    bool logarithmic_;
    double from_, to_;
    double low_ = 1e300, high_ = -1e300;
};

std::string number(double v) {
    const double size = std::abs(v);
    if (size >= 1e9) return fmt::format("{:g} G", v * 1e-9);
    if (size >= 1e6) return fmt::format("{:g} M", v * 1e-6);
    if (size >= 1e4) return fmt::format("{:g} k", v * 1e-3);
    return fmt::format("{:g}", v);
}

std::string mark(std::size_t shape, double x, double y, const std::string& color) {
    constexpr double r = 4;
    switch (shape % 4) {
        case 0:
            return fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{}' style='fill:{}'/>", x, y, r, color);
        case 1:
            return fmt::format("<rect x='{:.1f}' y='{:.1f}' width='{}' height='{}' style='fill:{}'/>", x - r, y - r,
                               2 * r, 2 * r, color);
        case 2:
            return fmt::format("<path d='M{:.1f} {:.1f}l{} {}h-{}z' style='fill:{}'/>", x, y - 1.2 * r, 1.2 * r, 2 * r,
                               2.4 * r, color);
        default:
            return fmt::format("<path d='M{:.1f} {:.1f}l{} {}l-{} {}l-{} -{}z' style='fill:{}'/>", x, y - 1.3 * r,
                               1.3 * r, 1.3 * r, 1.3 * r, 1.3 * r, 1.3 * r, 1.3 * r, color);
    }
}

void drawAxes(std::string& svg, const Plot& plot, const Frame& f, const Axis& x, const Axis& y) {
    for (const double tick : x.ticks()) {
        const double at = x.pixel(tick);
        svg += fmt::format("<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' style='stroke:var(--plot-lines,#ddd)'/>",
                           at, f.top, f.bottom);
        svg += fmt::format("<text x='{:.1f}' y='{}' text-anchor='middle'>{}</text>\n", at, f.bottom + 18, number(tick));
    }
    for (const double tick : y.ticks()) {
        const double at = y.pixel(tick);
        svg += fmt::format("<line x1='{1}' x2='{2}' y1='{0:.1f}' y2='{0:.1f}' style='stroke:var(--plot-lines,#ddd)'/>",
                           at, f.left, f.right);
        svg += fmt::format("<text x='{}' y='{:.1f}' text-anchor='end'>{}</text>\n", f.left - 8, at + 4, number(tick));
    }
    svg += fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='none' style='stroke:var(--plot-ink,#444)'/>\n",
                       f.left, f.top, f.right - f.left, f.bottom - f.top);
    svg += fmt::format("<text x='{}' y='{}' text-anchor='middle'>{}</text>\n", (f.left + f.right) / 2, f.bottom + 42,
                       escapeMarkup(plot.x_label));
    svg += fmt::format("<text transform='translate(18 {}) rotate(-90)' text-anchor='middle'>{}</text>\n",
                       (f.top + f.bottom) / 2, escapeMarkup(plot.y_label));
}

const char* dashOf(const Series& series) { return series.dashed ? " stroke-dasharray='6 4'" : ""; }

// Black ink is the page's.
std::string colorOf(std::size_t shape) {
    const std::string color = kPalette.at(shape % kPalette.size());
    return color == "#000000" ? "var(--plot-ink,black)" : color;
}

// From the lowest to the highest value; what the axis can't show of it is cut off at `end`.
std::string bar(double at, const std::pair<double, double>& range, const Axis& y, double end,
                const std::string& color) {
    const double high = y.pixel(range.second);
    const double low = y.shows(range.first) ? y.pixel(range.first) : end;
    return fmt::format(
        "<path d='M{0:.1f} {1:.1f}V{2:.1f}M{3:.1f} {1:.1f}h6M{3:.1f} {2:.1f}h6' fill='none' style='stroke:{4}'/>", at,
        low, high, at - 3, color);
}

void drawSeries(std::string& svg, const Series& series, std::size_t shape, const Axis& x, const Axis& y, double end) {
    std::string path;
    std::string marks;
    bool gap = true;
    for (std::size_t n = 0; n < series.points.size(); ++n) {
        const double px = series.points[n].first;
        const double py = series.points[n].second;
        if (!x.shows(px) || !y.shows(py)) {
            gap = gap || std::isnan(py);
            continue;
        }
        path += fmt::format("{}{:.1f} {:.1f}", gap ? 'M' : 'L', x.pixel(px), y.pixel(py));
        gap = false;
        if (n < series.bars.size() && y.shows(series.bars[n].second))
            marks += bar(x.pixel(px), series.bars[n], y, end, colorOf(shape));
        if (series.marked) marks += mark(shape, x.pixel(px), y.pixel(py), colorOf(shape));
    }
    if (series.joined && !path.empty())
        svg += fmt::format("<path d='{}' fill='none' style='stroke:{}' stroke-width='1.6'{}/>", path, colorOf(shape),
                           dashOf(series));
    svg += marks + '\n';
}

void drawLegend(std::string& svg, const Series& series, std::size_t shape, double left, double row) {
    if (series.joined)
        svg += fmt::format("<line x1='{0}' x2='{1}' y1='{2}' y2='{2}' style='stroke:{3}' stroke-width='1.6'{4}/>", left,
                           left + 26, row - 4, colorOf(shape), dashOf(series));
    if (series.marked || !series.joined) svg += mark(shape, left + 13, row - 4, colorOf(shape));
    svg += fmt::format("<text x='{}' y='{}'>{}</text>\n", left + 34, row, escapeMarkup(series.name));
}

}  // namespace

std::string escapeMarkup(std::string_view text) {
    std::string out;
    for (const char c : text) {
        if (c == '&')
            out += "&amp;";
        else if (c == '<')
            out += "&lt;";
        else if (c == '>')
            out += "&gt;";
        else if (c == '"')
            out += "&quot;";
        else if (c == '\'')
            out += "&#39;";
        else
            out += c;
    }
    return out;
}

std::vector<double> axisTicks(double low, double high, bool logarithmic) {
    std::vector<double> ticks;
    if (logarithmic) {
        const std::array<std::vector<int>, 3> ways{{{1}, {1, 2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9}}};
        for (const auto& digits : ways) {
            ticks.clear();
            const int last = static_cast<int>(std::ceil(std::log10(high)));
            for (int decade = static_cast<int>(std::floor(std::log10(low))); decade <= last; ++decade)
                for (const int digit : digits) {
                    const double v = digit * std::pow(10.0, decade);
                    if (v >= low && v <= high) ticks.push_back(v);
                }
            if (ticks.size() >= 3) return ticks;
        }
    }
    const double raw = (high - low) / 6;
    const double decade = std::pow(10.0, std::floor(std::log10(raw)));
    double step = 10 * decade;
    for (const double nice : {5.0, 2.0, 1.0})
        if (nice * decade * (1 + 1e-9) >= raw) step = nice * decade;
    ticks.clear();
    const double first = std::ceil(low / step);
    for (int n = 0; (first + n) * step <= high; ++n) ticks.push_back((first + n) * step);
    return ticks;
}

std::string drawSvg(const Plot& plot) {
    const Frame& f = plot.compact ? kCompact : kLarge;
    Axis x(plot.log_x, f.left, f.right);
    Axis y(plot.log_y, f.bottom, f.top);
    for (const Series& series : plot.series) {
        for (const auto& [px, py] : series.points)
            if (x.shows(px) && y.shows(py)) {
                x.include(px);
                y.include(py);
            }
        for (const auto& [low, high] : series.bars)
            for (const double v : {low, high})
                if (y.shows(v)) y.include(v);
    }
    const double rows = f.top + 20 * static_cast<double>(plot.series.size()) + 10;
    // Two entries of the legend a row.
    const double below = 20 * std::floor(static_cast<double>(std::max<std::size_t>(plot.series.size(), 1) - 1) / 2);
    // A letter of the legend takes about half of its height.
    std::size_t longest = 0;
    for (const Series& series : plot.series) longest = std::max(longest, series.name.size());
    const double width = plot.compact ? f.width : std::max(f.width, f.right + 62 + 6.4 * static_cast<double>(longest));
    const double height = plot.compact ? f.height + below : std::max(f.height, rows);
    std::string svg = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' "
        "font-family='sans-serif' font-size='12' style='fill:var(--plot-ink,black)'>\n"
        "<rect width='{0}' height='{1}' style='fill:var(--plot-paper,white)'/>\n"
        "<text x='{2}' y='22' text-anchor='middle' font-size='14' font-weight='bold'>{3}</text>\n",
        width, height, (f.left + f.right) / 2, escapeMarkup(plot.title));
    if (x.empty()) return svg + fmt::format("<text x='{}' y='{}'>no points</text></svg>\n", f.left, f.top + 40);
    x.settle();
    y.settle();
    drawAxes(svg, plot, f, x, y);
    const bool legend = !plot.compact || plot.series.size() > 1;
    const double column = (f.right - f.left) / 2;
    std::size_t next = 0;
    for (std::size_t n = 0; n < plot.series.size(); ++n) {
        const std::size_t shape = plot.series[n].color >= 0 ? static_cast<std::size_t>(plot.series[n].color) : next++;
        drawSeries(svg, plot.series[n], shape, x, y, f.bottom);
        const auto place = static_cast<double>(n);
        if (legend && plot.compact)
            drawLegend(svg, plot.series[n], shape, f.left + (n % 2 == 0 ? 0 : column),
                       f.bottom + 58 + 20 * std::floor(place / 2));
        if (legend && !plot.compact) drawLegend(svg, plot.series[n], shape, f.right + 22, f.top + 12 + 20 * place);
    }
    return svg + "</svg>\n";
}

}  // namespace stratum::report
