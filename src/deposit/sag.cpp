#include "deposit/sag.h"

#include "gcode/toolpath/plan_path.h"

#include <algorithm>
#include <cmath>

namespace stratum::deposit {
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
