#include "deposit/bead_support.h"

#include "base/parallel_for.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::deposit {
namespace {

using gcode::PlanPath;
using gcode::PlanPoint;

constexpr double kBisectedTo = 1e-6;  // mm
constexpr double kMostSteps = 4096;   // along one path, so that an absurdly long arc ends

// The parameters t of a line p + t u for which it lies in a convex region; empty while from > to.
struct LineRange {
    double from = 1e300;
    double to = -1e300;

    void unite(const LineRange& other) {
        from = std::min(from, other.from);
        to = std::max(to, other.to);
    }
    // Keeps t with low <= value + t * slope <= high.
    void clip(double value, double slope, double low, double high) {
        if (slope == 0) {
            if (value < low || value > high) *this = {};
            return;
        }
        const double a = (low - value) / slope;
        const double b = (high - value) / slope;
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
};

// In a disc about a point that lies (x, y) from the line's origin.
LineRange inDisc(double ux, double uy, double x, double y, double radius) {
    const double along = x * ux + y * uy;
    const double across = x * uy - y * ux;
    const double half2 = radius * radius - across * across;
    if (!(half2 >= 0)) return {};
    const double half = std::sqrt(half2);
    return {along - half, along + half};
}

// Of the same disc, where the point lies more across the line than along it.
LineRange besideDisc(double ux, double uy, double x, double y, double radius) {
    LineRange range = inDisc(ux, uy, x, y, radius);
    range.clip(-(x * ux + y * uy), 1, -std::abs(x * uy - y * ux), std::abs(x * uy - y * ux));
    return range;
}

// But for the reach.
bool beside(const PlanPath& path, double mm, const PlanPath& other, PathPart held) {
    const PlanPoint here = path.at(mm);
    const double nearest = other.nearest(here.x, here.y);
    if (nearest < held.from || nearest > held.to) return false;
    if (!(path.length() > 0)) return true;
    const PlanPoint u = path.direction(mm);
    const PlanPoint there = other.at(nearest);
    const double dx = there.x - here.x;
    const double dy = there.y - here.y;
    return std::abs(dx * u.x + dy * u.y) <= std::abs(dx * u.y - dy * u.x);
}

// What is within reach of a segment is two discs and the rectangle between them. It is convex, so the line is in it
// from where it first meets one of the three to where it leaves the last.
void segmentNearSegment(const PlanPath& path, const PlanPath& other, double reach, std::vector<PathPart>& parts) {
    const PlanPoint start = path.at(0);
    const PlanPoint u = path.direction(0);
    const PlanPoint other_start = other.at(0);
    const PlanPoint v = other.direction(0);
    const double ax = other_start.x - start.x;
    const double ay = other_start.y - start.y;
    LineRange range = inDisc(u.x, u.y, ax, ay, reach);
    if (other.length() > 0) {
        const PlanPoint other_end = other.at(other.length());
        range.unite(inDisc(u.x, u.y, other_end.x - start.x, other_end.y - start.y, reach));
        LineRange between{-1e300, 1e300};
        between.clip(-(ax * v.x + ay * v.y), u.x * v.x + u.y * v.y, 0, other.length());
        between.clip(ax * v.y - ay * v.x, v.x * u.y - v.y * u.x, -reach, reach);
        if (between.from <= between.to) range.unite(between);
    }
    const double from = std::max(range.from, 0.0);
    const double to = std::min(range.to, path.length());
    if (from <= to) parts.push_back({from, to});
}

// What is nearest to a place in the other's interior lies square to it, so that there the angle between the two decides
// what is beside; what is nearest to an end is in the half plane beyond it.
void segmentBesideSegment(const PlanPath& path, const PlanPath& other, PathPart held, double reach,
                          std::vector<PathPart>& parts) {
    const PlanPoint start = path.at(0);
    const PlanPoint u = path.direction(0);
    const PlanPoint other_start = other.at(0);
    const PlanPoint other_end = other.at(other.length());
    const PlanPoint v = other.direction(0);
    const double ax = other_start.x - start.x;
    const double ay = other_start.y - start.y;
    const double foot = -(ax * v.x + ay * v.y);  // on the other, of this path's start
    const double slope = u.x * v.x + u.y * v.y;
    const double turn = v.x * u.y - v.y * u.x;
    const auto keep = [&](LineRange range) {
        range.clip(0, 1, 0, path.length());
        if (range.from < range.to) parts.push_back({range.from, range.to});
    };
    if (std::abs(slope) > std::abs(turn)) {
        LineRange range{0, path.length()};
        range.clip(foot, slope, held.from, held.to);
        range.clip(ax * v.y - ay * v.x, turn, -reach, reach);
        keep(range);
    }
    if (held.from <= 0) {
        LineRange range = besideDisc(u.x, u.y, ax, ay, reach);
        range.clip(foot, slope, -1e300, 0);
        keep(range);
    }
    if (held.to >= other.length()) {
        LineRange range = besideDisc(u.x, u.y, other_end.x - start.x, other_end.y - start.y, reach);
        range.clip(foot, slope, other.length(), 1e300);
        keep(range);
    }
}

// The parts in which `beyond` is not above 0. A step as long as its absolute value passes nothing over, as the distance
// to another path changes by a mm per mm at most. Returns the number of its values.
template <typename Beyond>
std::size_t walk(const PlanPath& path, const Beyond& beyond, std::vector<PathPart>& parts) {
    const double length = path.length();
    const double least = std::max(kFineStep, length / kMostSteps);
    std::size_t values = 1;
    double begin = 0;
    double here = 0;
    double gap = beyond(0);
    while (here < length) {
        const double next = std::min(length, here + std::max(least, std::abs(gap)));
        const double next_gap = beyond(next);
        ++values;
        if ((gap <= 0) != (next_gap <= 0)) {
            double low = here;
            double high = next;
            while (high - low > kBisectedTo) {
                const double middle = 0.5 * (low + high);
                if (middle <= low || middle >= high) break;  // no double lies between them
                ((beyond(middle) <= 0) == (gap <= 0) ? low : high) = middle;
                ++values;
            }
            if (gap <= 0)
                parts.push_back({begin, low});
            else
                begin = high;
        }
        here = next;
        gap = next_gap;
    }
    if (gap <= 0) parts.push_back({begin, length});
    return values;
}

}  // namespace

std::size_t partsNear(const PlanPath& path, const PlanPath& other, double reach, std::vector<PathPart>& parts) {
    if (!path.straight() || !other.straight())
        return walk(
            path,
            [&](double mm) {
                const PlanPoint place = path.at(mm);
                return other.distance(place.x, place.y) - reach;
            },
            parts);
    if (path.length() > 0) {
        segmentNearSegment(path, other, reach, parts);
    } else if (other.distance(path.at(0).x, path.at(0).y) <= reach) {
        parts.push_back({0, 0});
    }
    return 1;
}

std::size_t partsBeside(const PlanPath& path, const PlanPath& other, PathPart held, double reach,
                        std::vector<PathPart>& parts) {
    if (path.straight() && other.straight() && path.length() > 0) {
        segmentBesideSegment(path, other, held, reach, parts);
        return 1;
    }
    const std::size_t before = parts.size();
    const std::size_t distances = walk(
        path,
        [&](double mm) {
            const PlanPoint place = path.at(mm);
            const double gap = other.distance(place.x, place.y) - reach;
            if (gap > 0) return gap;
            return beside(path, mm, other, held) ? 0 : kFineStep;
        },
        parts);
    // Where two paths meet, the direction between them is rounding.
    const double shortest = std::min(kFineStep, path.length());
    const auto first = parts.begin() + static_cast<std::ptrdiff_t>(before);
    parts.erase(
        std::remove_if(first, parts.end(), [&](const PathPart& part) { return part.to - part.from < shortest; }),
        parts.end());
    return distances;
}

namespace {

constexpr double kLeastCell = 2;  // mm
constexpr double kMostCellsAcross = 1024;
constexpr double kMostVisits = 2e7;         // entries of all cells, about; more of them get larger cells
constexpr double kLargestCoordinate = 1e6;  // mm; beyond it a millimetre's parts are lost in a double's products
constexpr double kChordTurn = 0.25;         // radians of an arc that are entered as one chord
constexpr double kJoined = 1e-6;            // mm between two parts that are one
constexpr std::size_t kMergedAfter = 64;    // parts

// Of BeadSupport::below_
constexpr std::uint32_t kNone = 0xffffffff;
constexpr std::uint32_t kWhole = 0xfffffffe;
constexpr std::size_t kSearchBlock = 4096;  // beads that one thread searches below of at a time

constexpr std::uint32_t kNoBead = 0xffffffff;

bool isSupportMaterial(gcode::Feature feature) {
    return feature == gcode::Feature::support || feature == gcode::Feature::support_interface;
}

double touching(double height) { return kTouchingShare * height + kTouchingRounding; }

// Ascending and apart.
void mergeParts(std::vector<PathPart>& parts) {
    std::sort(parts.begin(), parts.end(), [](const PathPart& a, const PathPart& b) { return a.from < b.from; });
    std::size_t kept = 0;
    for (const PathPart& part : parts) {
        if (kept > 0 && part.from <= parts[kept - 1].to + kJoined)
            parts[kept - 1].to = std::max(parts[kept - 1].to, part.to);
        else
            parts[kept++] = part;
    }
    parts.resize(kept);
}

bool covers(const std::vector<PathPart>& parts, double length) {
    return parts.size() == 1 && parts[0].from <= 0 && parts[0].to >= length;
}

}  // namespace

BeadSupport::BeadSupport(const gcode::Toolpath& toolpath) : toolpath_(toolpath) {
    lowest_layer_ = std::numeric_limits<std::uint32_t>::max();
    level_.resize(toolpath.beads.size());
    for (std::size_t n = 0; n < level_.size(); ++n) {
        const gcode::Bead& bead = toolpath.beads[n];
        const std::uint32_t layer = toolpath.runOf(bead).layer;
        if (layer >= 1) lowest_layer_ = std::min(lowest_layer_, layer);
        level_[n] = usable(bead);
    }
    setGrid();
    fillGrid();
    searchBelowAll();
}

bool BeadSupport::usable(const gcode::Bead& bead) const {
    const auto fine = [](double mm) { return std::abs(mm) <= kLargestCoordinate; };
    const auto size = [](float mm) { return mm > 0 && static_cast<double>(mm) <= kLargestCoordinate; };
    if (!(bead.z0 == bead.z1) || !size(bead.width) || !size(toolpath_.runOf(bead).height)) return false;
    if (!fine(bead.x0) || !fine(bead.y0) || !fine(bead.x1) || !fine(bead.y1) || !fine(bead.z0)) return false;
    if (bead.arc < 0) return true;
    const gcode::Arc& arc = toolpath_.arcs[static_cast<std::size_t>(bead.arc)];
    return fine(arc.center_x) && fine(arc.center_y) && std::abs(arc.sweep) <= 7;  // a turn, rounded
}

bool BeadSupport::everywhere(const gcode::Bead& bead) const {
    const gcode::Run& run = toolpath_.runOf(bead);
    if (run.layer <= lowest_layer_ || run.feature == gcode::Feature::ironing) return true;
    const double height = static_cast<double>(run.height);
    return bead.z0 - height <= touching(height);
}

bool BeadSupport::below(const gcode::Bead& lower, const gcode::Bead& upper) const {
    const gcode::Run& run = toolpath_.runOf(upper);
    const double height = static_cast<double>(run.height);
    const bool parts_later = isSupportMaterial(run.feature) != isSupportMaterial(toolpath_.runOf(lower).feature);
    const double gap = parts_later ? kSupportClearance : touching(height);
    return lower.z0 >= upper.z0 - height - gap && lower.z0 <= upper.z0 - kLeastBurial * height;
}

double BeadSupport::reach(const gcode::Bead& lower, const gcode::Bead& upper) {
    return kContact * 0.5 * (static_cast<double>(lower.width) + static_cast<double>(upper.width));
}

bool BeadSupport::holds(const gcode::Bead& neighbour, const gcode::Bead& bead) const {
    return std::abs(neighbour.z0 - bead.z0) <= kTouchingRounding &&
           toolpath_.runOf(neighbour).feature != gcode::Feature::ironing;
}

double BeadSupport::reachBeside(const gcode::Bead& a, const gcode::Bead& b) {
    return kBeside * 0.5 * (static_cast<double>(a.width) + static_cast<double>(b.width));
}

void BeadSupport::setGrid() {
    double min_x = 1e300;
    double min_y = 1e300;
    double max_x = -1e300;
    double max_y = -1e300;
    double total = 0;
    for (std::size_t n = 0; n < level_.size(); ++n) {
        if (!level_[n]) continue;
        const gcode::Bead& bead = toolpath_.beads[n];
        const gcode::PlanPath path(toolpath_, bead);
        const double side = path.straight() ? 0 : 2 * path.radius();  // as far as an arc can be from its ends
        min_x = std::min(min_x, std::min<double>(bead.x0, bead.x1) - side);
        min_y = std::min(min_y, std::min<double>(bead.y0, bead.y1) - side);
        max_x = std::max(max_x, std::max<double>(bead.x0, bead.x1) + side);
        max_y = std::max(max_y, std::max<double>(bead.y0, bead.y1) + side);
        total += path.length();
    }
    if (!(max_x >= min_x)) return;
    const double extent = std::max(max_x - min_x, max_y - min_y);
    cell_ = std::max({kLeastCell, extent / kMostCellsAcross, total / kMostVisits});
    origin_x_ = min_x;
    origin_y_ = min_y;
    columns_ = static_cast<long>((max_x - min_x) / cell_) + 1;
    rows_ = static_cast<long>((max_y - min_y) / cell_) + 1;
}

// Visits the cells within half the reach of a bead, some of them twice. Where two beads are within reach of each other,
// the place between them is within its own bead's half of it from both, so they share that cell.
template <typename Visit>
void BeadSupport::visitCells(const gcode::Bead& bead, const Visit& visit) const {
    const gcode::PlanPath path(toolpath_, bead);
    const int chords = std::max(1, static_cast<int>(std::ceil(std::abs(path.turn()) / kChordTurn)));
    const double off_chord = path.radius() * (1 - std::cos(0.5 * path.turn() / chords));
    const double side = kBeside * 0.5 * static_cast<double>(bead.width) + off_chord + kTouchingRounding;
    const auto cellOf = [this](double mm, double origin, long count) {
        return static_cast<long>(std::clamp((mm - origin) / cell_, 0.0, static_cast<double>(count - 1)));
    };
    gcode::PlanPoint a = path.at(0);
    for (int chord = 1; chord <= chords; ++chord) {
        const gcode::PlanPoint b = path.at(path.length() * chord / chords);
        const long last_row = cellOf(std::max(a.y, b.y) + side, origin_y_, rows_);
        for (long row = cellOf(std::min(a.y, b.y) - side, origin_y_, rows_); row <= last_row; ++row) {
            // The part of the chord from which this row can be reached; outer rows hold what is beyond them too.
            double from = 0;
            double to = 1;
            if (std::abs(b.y - a.y) > kJoined) {
                const double low = (origin_y_ + static_cast<double>(row) * cell_ - side - a.y) / (b.y - a.y);
                const double high = low + (cell_ + 2 * side) / (b.y - a.y);
                from = std::clamp(std::min(low, high), 0.0, 1.0);
                to = std::clamp(std::max(low, high), 0.0, 1.0);
            }
            const double from_x = std::lerp(a.x, b.x, from);
            const double to_x = std::lerp(a.x, b.x, to);
            const long last = cellOf(std::max(from_x, to_x) + side, origin_x_, columns_);
            for (long column = cellOf(std::min(from_x, to_x) - side, origin_x_, columns_); column <= last; ++column)
                visit(static_cast<std::size_t>(row * columns_ + column));
        }
        a = b;
    }
}

void BeadSupport::fillGrid() {
    std::vector<std::uint32_t> by_top;
    for (std::uint32_t n = 0; n < level_.size(); ++n)
        if (level_[n]) by_top.push_back(n);
    std::stable_sort(by_top.begin(), by_top.end(), [this](std::uint32_t a, std::uint32_t b) {
        return double{toolpath_.beads[a].z0} < double{toolpath_.beads[b].z0};
    });
    const std::size_t cells = static_cast<std::size_t>(columns_ * rows_);
    starts_.assign(cells + 1, 0);
    // Chords of an arc share cells.
    std::vector<std::uint32_t> last(cells, kNoBead);
    for (const std::uint32_t n : by_top)
        visitCells(toolpath_.beads[n], [&](std::size_t cell) {
            if (last[cell] != n) ++starts_[cell + 1];
            last[cell] = n;
        });
    for (std::size_t cell = 1; cell < starts_.size(); ++cell) starts_[cell] += starts_[cell - 1];
    entries_.resize(starts_.back());
    std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
    last.assign(cells, kNoBead);
    for (const std::uint32_t n : by_top) {
        const auto top = static_cast<float>(toolpath_.beads[n].z0);
        visitCells(toolpath_.beads[n], [&](std::size_t cell) {
            if (last[cell] != n) entries_[next[cell]++] = {top, n};
            last[cell] = n;
        });
    }
}

// Collects in search.candidates the level beads with their tops in this range that share a cell with a bead and are
// accepted, each once; returns false past one of the bounds.
template <typename Accept>
bool BeadSupport::gather(std::uint32_t bead, double lowest, double highest, const Accept& accept,
                         Search& search) const {
    const double rounding = 1e-6 * (1 + std::max(std::abs(lowest), std::abs(highest)));  // of a float's top
    const auto low = static_cast<float>(lowest - rounding);
    const auto high = static_cast<float>(highest + rounding);
    std::vector<std::uint32_t>& candidates = search.candidates;
    candidates.clear();
    if (search.asked.empty()) search.asked.resize(level_.size());
    ++search.searches;
    bool few = true;
    visitCells(toolpath_.beads[bead], [&](std::size_t cell) {
        if (!few) return;
        const auto begin = entries_.begin() + static_cast<std::ptrdiff_t>(starts_[cell]);
        const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(starts_[cell + 1]);
        const auto first = std::lower_bound(begin, end, low, [](const Entry& one, float top) { return one.top < top; });
        const auto last = std::upper_bound(first, end, high, [](float top, const Entry& one) { return top < one.top; });
        few = static_cast<std::size_t>(last - first) <= kMostInCell;
        for (auto entry = first; few && entry != last; ++entry) {
            if (search.asked[entry->bead] == search.searches) continue;
            search.asked[entry->bead] = search.searches;
            if (accept(entry->bead)) candidates.push_back(entry->bead);
            few = candidates.size() <= kMostDistances;
        }
    });
    return few;
}

// Appends what the candidates give, until that is the whole path. append(candidate) returns the distances it took.
template <typename Append>
void BeadSupport::unite(const gcode::PlanPath& path, const std::vector<std::uint32_t>& candidates,
                        std::vector<PathPart>& parts, const Append& append) {
    std::size_t distances = 0;
    std::size_t merge_at = parts.size() + kMergedAfter;
    for (const std::uint32_t candidate : candidates) {
        const std::size_t before = parts.size();
        distances += append(candidate);
        bool whole = distances > kMostDistances;
        for (std::size_t n = before; n < parts.size(); ++n)
            whole = whole || (parts[n].from <= 0 && parts[n].to >= path.length());
        if (!whole && parts.size() >= merge_at) {
            mergeParts(parts);
            whole = covers(parts, path.length());
            merge_at = 2 * parts.size() + kMergedAfter;
        }
        if (whole) {
            parts.assign(1, {0, path.length()});
            return;
        }
    }
    mergeParts(parts);
}

void BeadSupport::searchBelow(std::uint32_t bead, std::vector<PathPart>& parts, Search& search) const {
    const gcode::Bead& upper = toolpath_.beads[bead];
    const gcode::PlanPath path(toolpath_, upper);
    const double height = static_cast<double>(toolpath_.runOf(upper).height);
    const double lowest = upper.z0 - height - std::max(kSupportClearance, touching(height));
    const auto carries = [&](std::uint32_t lower) { return below(toolpath_.beads[lower], upper); };
    if (everywhere(upper) || !gather(bead, lowest, upper.z0 - kLeastBurial * height, carries, search)) {
        parts.push_back({0, path.length()});
        return;
    }
    unite(path, search.candidates, parts, [&](std::uint32_t n) {
        const gcode::Bead& lower = toolpath_.beads[n];
        return partsNear(path, gcode::PlanPath(toolpath_, lower), reach(lower, upper), parts);
    });
}

void BeadSupport::searchBelowAll() {
    below_.resize(level_.size());
    below_parts_.resize((level_.size() + kSearchBlock - 1) / kSearchBlock);
    PerThread<Search> searches;
    parallelFor(below_parts_.size(), 1, [&](std::size_t first, std::size_t last) {
        Search& search = searches.local();
        std::vector<PathPart> parts;
        for (auto bead = static_cast<std::uint32_t>(first * kSearchBlock);
             bead < std::min(last * kSearchBlock, level_.size()); ++bead) {
            if (!level_[bead]) continue;
            parts.clear();
            searchBelow(bead, parts, search);
            std::vector<PathPart>& kept = below_parts_[bead / kSearchBlock];
            if (parts.empty()) {
                below_[bead] = kNone;
            } else if (covers(parts, gcode::PlanPath(toolpath_, toolpath_.beads[bead]).length())) {
                below_[bead] = kWhole;
            } else {
                below_[bead] = static_cast<std::uint32_t>(kept.size());
                kept.insert(kept.end(), parts.begin(), parts.end());
                kept.push_back({1, 0});
            }
        }
    });
}

void BeadSupport::fromBelow(std::uint32_t bead, std::vector<PathPart>& parts) const {
    parts.clear();
    const std::uint32_t found = below_[bead];
    if (found == kNone) return;
    if (found == kWhole) {
        parts.push_back({0, gcode::PlanPath(toolpath_, toolpath_.beads[bead]).length()});
        return;
    }
    for (auto part = below_parts_[bead / kSearchBlock].begin() + found; part->from <= part->to; ++part)
        parts.push_back(*part);
}

void BeadSupport::find(std::uint32_t bead, std::vector<PathPart>& parts, Search& search) const {
    fromBelow(bead, parts);
    const gcode::Bead& middle = toolpath_.beads[bead];
    const gcode::PlanPath path(toolpath_, middle);
    if (covers(parts, path.length())) return;
    const auto neighbours = [&](std::uint32_t n) { return n != bead && holds(toolpath_.beads[n], middle); };
    if (!gather(bead, middle.z0 - kTouchingRounding, middle.z0 + kTouchingRounding, neighbours, search)) {
        parts.assign(1, {0, path.length()});
        return;
    }
    unite(path, search.candidates, parts, [&](std::uint32_t n) {
        fromBelow(n, search.neighbour_parts);
        std::size_t distances = 0;
        const gcode::Bead& neighbour = toolpath_.beads[n];
        for (const PathPart& held : search.neighbour_parts)
            distances +=
                partsBeside(path, gcode::PlanPath(toolpath_, neighbour), held, reachBeside(neighbour, middle), parts);
        return distances;
    });
}

}  // namespace stratum::deposit
