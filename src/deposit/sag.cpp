#include "deposit/sag.h"

#include "base/parallel_for.h"
#include "deposit/bead_support.h"
#include "gcode/toolpath/plan_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace stratum::deposit {
namespace {

constexpr double kSameEnd = 1e-3;          // mm in the plan between two beads that are joined
constexpr double kSameLevel = 1e-6;        // mm in z, for relative coordinates that were added up
constexpr double kChordError = 0.01;       // of a bead's height
constexpr int kMostPieces = 32;            // of a span
constexpr std::size_t kChainBlock = 4096;  // beads in which one thread looks for the begins of chains at a time

bool joined(const gcode::Toolpath& toolpath, const gcode::Bead& a, const gcode::Bead& b) {
    return std::abs(a.z1 - b.z0) <= kSameLevel && std::hypot(a.x1 - b.x0, a.y1 - b.y0) <= kSameEnd &&
           toolpath.runOf(a).tool == toolpath.runOf(b).tool;
}

// Steps of length d leave an error of fraction d^2 / length, an eighth of the curvature 8 fraction / length.
int piecesOf(double length, double height, double fraction) {
    const double wanted = std::sqrt(fraction * length / (kChordError * height));
    return 2 * static_cast<int>(std::ceil(0.5 * std::clamp(wanted, 2.0, double{kMostPieces})));
}

// Finds the spans of one chain of beads.
class Chain {
public:
    Chain(const gcode::Toolpath& toolpath, double fraction) : toolpath_(toolpath), fraction_(fraction) {}

    void clear(std::uint32_t first) {
        first_ = first;
        joints_.assign(1, 0.0);
        lengths_.clear();
        supported_.clear();
    }

    // The next bead, with its supported parts.
    void add(double length, std::span<const PathPart> parts) {
        const double begin = joints_.back();
        for (const PathPart& part : parts) {
            // A part up to the bead's end must end at the joint to the bit.
            const PathPart moved{begin + part.from, part.to >= length ? begin + length : begin + part.to};
            if (!supported_.empty() && moved.from <= supported_.back().to)
                supported_.back().to = std::max(supported_.back().to, moved.to);
            else
                supported_.push_back(moved);
        }
        joints_.push_back(begin + length);
        lengths_.push_back(length);
    }

    // What lies between two supported parts; both ends of the chain are free.
    void collect(HangingSpans& hanging) const {
        for (std::size_t n = 1; n < supported_.size(); ++n)
            addSpan(nearestJoint(supported_[n - 1].to), nearestJoint(supported_[n].from), hanging);
    }

private:
    double nearestJoint(double s) const {
        const auto above = std::lower_bound(joints_.begin(), joints_.end(), s);
        if (above != joints_.end() && *above - s < kLeastPiece) return *above;
        if (above != joints_.begin() && s - *(above - 1) < kLeastPiece) return *(above - 1);
        return s;
    }

    void addSpan(double begin, double end, HangingSpans& hanging) const {
        if (!(end > begin)) return;
        // From the bead in which it begins, behind zero-length beads there, to the one in which it ends.
        const auto from = std::upper_bound(joints_.begin(), joints_.end(), begin) - joints_.begin() - 1;
        const auto to = std::lower_bound(joints_.begin(), joints_.end(), end) - joints_.begin();
        double width = 0;
        double height = std::numeric_limits<double>::max();
        for (auto n = from; n < to; ++n) {
            const gcode::Bead& bead = toolpath_.beads[first_ + static_cast<std::size_t>(n)];
            width = std::max(width, static_cast<double>(bead.width));
            height = std::min(height, static_cast<double>(toolpath_.runOf(bead).height));
        }
        const double length = end - begin;
        if (length < width) return;
        const auto span = static_cast<std::uint32_t>(hanging.spans.size());
        hanging.spans.push_back({length, piecesOf(length, height, fraction_)});
        for (auto n = from; n < to; ++n) {
            const double bead_begin = joints_[static_cast<std::size_t>(n)];
            const double bead_end = joints_[static_cast<std::size_t>(n) + 1];
            const double part_begin = std::max(begin, bead_begin);
            hanging.parts.push_back({.bead = first_ + static_cast<std::uint32_t>(n),
                                     .span = span,
                                     .from = part_begin - bead_begin,
                                     .to = end < bead_end ? end - bead_begin : lengths_[static_cast<std::size_t>(n)],
                                     .before = part_begin - begin});
        }
    }

    const gcode::Toolpath& toolpath_;
    double fraction_;
    std::uint32_t first_ = 0;
    std::vector<double> joints_;       // mm of the chain
    std::vector<double> lengths_;      // mm, of its beads
    std::vector<PathPart> supported_;  // of the chain
};

// Appends the spans of the chains that begin in [first, last).
void findSpans(const gcode::Toolpath& toolpath, const BeadSupport& support, std::size_t first, std::size_t last,
               double fraction, BeadSupport::Search& search, HangingSpans& hanging) {
    const auto follows = [&](std::size_t n) {
        return n > 0 && n < toolpath.beads.size() && support.level(static_cast<std::uint32_t>(n)) &&
               support.level(static_cast<std::uint32_t>(n - 1)) &&
               joined(toolpath, toolpath.beads[n - 1], toolpath.beads[n]);
    };
    Chain chain(toolpath, fraction);
    std::vector<PathPart> parts;
    for (std::size_t begin = first; begin < last; ++begin) {
        if (!support.level(static_cast<std::uint32_t>(begin)) || follows(begin)) continue;
        chain.clear(static_cast<std::uint32_t>(begin));
        for (std::size_t n = begin; n == begin || follows(n); ++n) {
            support.find(static_cast<std::uint32_t>(n), parts, search);
            chain.add(gcode::PlanPath(toolpath, toolpath.beads[n]).length(), parts);
        }
        chain.collect(hanging);
    }
}

}  // namespace

HangingSpans findHangingSpans(const gcode::Toolpath& toolpath, double fraction) {
    const BeadSupport support(toolpath);
    const std::size_t count = toolpath.beads.size();
    std::vector<HangingSpans> blocks((count + kChainBlock - 1) / kChainBlock);
    PerThread<BeadSupport::Search> searches;
    parallelFor(blocks.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n)
            findSpans(toolpath, support, n * kChainBlock, std::min((n + 1) * kChainBlock, count), fraction,
                      searches.local(), blocks[n]);
    });
    HangingSpans all;
    for (HangingSpans& block : blocks) {
        for (HangingPart& part : block.parts) part.span += static_cast<std::uint32_t>(all.spans.size());
        all.spans.insert(all.spans.end(), block.spans.begin(), block.spans.end());
        all.parts.insert(all.parts.end(), block.parts.begin(), block.parts.end());
    }
    return all;
}

namespace {

constexpr double kSteepest = 0.99;  // mm per mm
constexpr double kRounding = 1e-9;  // mm

}  // namespace

double sagDrop(double length, double s, double fraction) {
    const double left = std::min(s, length - s);
    if (!(left > kRounding)) return 0;  // an end is where the bead is, to the bit
    return std::min(4 * fraction * s * (length - s) / length, kSteepest * left);
}

Sag::Sag(const gcode::Toolpath& toolpath, double fraction)
    : toolpath_(toolpath), fraction_(std::min(fraction, kMostSag)), hanging_(findHangingSpans(toolpath, fraction_)) {}

SagReport Sag::report() const {
    SagReport report;
    for (const HangingSpan& span : hanging_.spans) {
        ++report.spans;
        report.length_mm += span.length;
        report.deepest_mm = std::max(report.deepest_mm, sagDrop(span.length, 0.5 * span.length, fraction_));
    }
    return report;
}

void Sag::lay(const BeadPiece& piece, BeadCutter& cutter) {
    if (piece.apart) return cutter.add(piece);  // a string hangs already
    const std::vector<HangingPart>& parts = hanging_.parts;
    while (next_ < parts.size() && parts[next_].bead < piece.bead) ++next_;
    if (next_ == parts.size() || parts[next_].bead != piece.bead) {
        cutter.add(piece);
        return;
    }
    source_ = piece;
    length_ = gcode::PlanPath(toolpath_, toolpath_.beads[piece.bead]).length();
    pieces_.clear();
    weights_.clear();
    const double begin = piece.from * length_;
    const double end = piece.to < 1 ? piece.to * length_ : length_;
    double done = begin;
    for (std::size_t n = next_; n < parts.size() && parts[n].bead == piece.bead; ++n) {
        const double from = std::max(parts[n].from, begin);
        const double to = std::min(parts[n].to, end);
        if (begin == end ? !(from == to) : !(from < to)) continue;
        if (from > done) add(done / length_, from / length_, 0, 0);
        addHanging(parts[n], from, to);
        done = to;
        if (begin == end) break;
    }
    if (done < end || pieces_.empty()) add(done > begin ? done / length_ : piece.from, piece.to, 0, 0);
    double total = 0;
    for (const double weight : weights_) total += weight;
    for (std::size_t n = 0; n < pieces_.size(); ++n) {
        // What was simulated, by the volumes of the pieces.
        const double share = total > 0 ? weights_[n] / total : 1 / static_cast<double>(pieces_.size());
        pieces_[n].flow.volume = static_cast<float>(share * static_cast<double>(piece.flow.volume));
        cutter.add(pieces_[n]);
    }
}

// The part of the piece in [from, to] (mm of the bead), which is in the span of `part`.
void Sag::addHanging(const HangingPart& part, double from, double to) {
    const HangingSpan& span = hanging_.spans[part.span];
    const double step = span.length / span.pieces;
    const double before = part.before + (from - part.from);
    const double after = part.before + (to - part.from);
    if (from == to) {  // a disc, or a bead of no length, only moves down
        const double drop = sagDrop(span.length, before, fraction_);
        add(source_.from, source_.to, drop, drop);
        return;
    }
    double s = before;
    for (double knot = std::floor(s / step) + 1; s < after; ++knot) {
        double next = knot * step;
        if (next <= s + kLeastPiece) continue;
        if (next >= after - kLeastPiece) next = after;
        const double piece_from = from + (s - before);
        const double piece_to = next == after ? to : from + (next - before);
        add(piece_from / length_, piece_to / length_, sagDrop(span.length, s, fraction_),
            sagDrop(span.length, next, fraction_));
        s = next;
    }
}

// A part of the piece; fractions are of the bead.
void Sag::add(double from, double to, double drop0, double drop1) {
    BeadPiece piece = source_;
    piece.from = from;
    piece.to = to;
    piece.drop0 = drop0;
    piece.drop1 = drop1;
    const double all = source_.to - source_.from;
    if (!(all > 0) || (from <= source_.from && to >= source_.to && drop0 == drop1)) {
        pieces_.push_back(piece);
        weights_.push_back(1);
        return;
    }
    // The width changes evenly along the piece.
    const double first = (from - source_.from) / all;
    const double last = (to - source_.from) / all;
    const double widening = static_cast<double>(source_.flow.widening);
    double width = std::max(static_cast<double>(source_.width) + widening * (0.5 * (first + last) - 0.5), 0.0);
    weights_.push_back(areaOf(width) * (last - first));
    piece.flow.widening = static_cast<float>((last - first) * widening);
    if (drop0 != drop1) {
        piece.flow.widening = 0;
        const double plan = (to - from) * length_;
        width = gcode::sectionWidth(areaOf(width) * plan / std::hypot(plan, drop1 - drop0), heightOf());
    }
    piece.width = static_cast<float>(width);
    // Where it is cut, the nozzle passes with the piece's highest speed.
    gcode::BeadTiming& timing = piece.timing;
    timing.start += first * static_cast<double>(timing.seconds);
    timing.seconds = static_cast<float>((last - first) * static_cast<double>(timing.seconds));
    if (first > 0) timing.entry = timing.peak;
    if (last < 1) timing.exit = timing.peak;
    pieces_.push_back(piece);
}

double Sag::heightOf() const { return static_cast<double>(toolpath_.runOf(toolpath_.beads[source_.bead]).height); }

double Sag::areaOf(double width) const { return gcode::sectionArea(width, heightOf()); }

SagReport sagBeads(gcode::Toolpath& toolpath, double fraction) {
    if (!(fraction > 0)) return {};
    Sag sag(toolpath, fraction);
    if (sag.none()) return {};
    BeadCutter cutter(toolpath, !toolpath.flow.empty(), toolpath.beads.size() + 16 * sag.report().spans);
    for (std::uint32_t n = 0; n < toolpath.beads.size(); ++n) sag.lay(wholeBead(toolpath, n), cutter);
    cutter.finish();
    return sag.report();
}

}  // namespace stratum::deposit
