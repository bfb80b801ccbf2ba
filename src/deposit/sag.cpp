#include "deposit/sag.h"

#include "deposit/bead_cutter.h"
#include "deposit/bead_path.h"
#include "deposit/bead_support.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace stratum::deposit {
namespace {

constexpr double kSameEnd = 1e-3;     // mm in the plan between two beads that are joined
constexpr double kSameLevel = 1e-6;   // mm in z, for relative coordinates that were added up
constexpr double kSteepest = 0.99;    // mm per mm
constexpr double kChordError = 0.01;  // of a bead's height
constexpr double kRounding = 1e-9;    // mm
constexpr int kMostPieces = 32;       // of a span
constexpr double kLeastPiece = 1e-3;  // mm; an end of a span that is closer to a joint moves there

// A stretch without support that hangs.
struct Hanging {
    double length = 0;  // mm
    int pieces = 2;     // even, so that one ends in the middle
    double drop(double s, double fraction) const {
        const double left = std::min(s, length - s);
        if (!(left > kRounding)) return 0;  // an end is where the bead is, to the bit
        return std::min(4 * fraction * s * (length - s) / length, kSteepest * left);
    }
};

// The part of a bead that is in a span.
struct HangingPart {
    std::uint32_t bead = 0;
    std::uint32_t span = 0;
    double from = 0, to = 0;  // mm of the bead's path
    double before = 0;        // mm of the span before this part
};

struct HangingParts {
    std::vector<Hanging> spans;
    std::vector<HangingPart> parts;  // in print order
};

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
    void collect(HangingParts& hanging) const {
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

    void addSpan(double begin, double end, HangingParts& hanging) const {
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

HangingParts findSpans(const gcode::Toolpath& toolpath, double fraction) {
    HangingParts hanging;
    BeadSupport support(toolpath);
    Chain chain(toolpath, fraction);
    std::vector<PathPart> parts;
    const auto count = static_cast<std::uint32_t>(toolpath.beads.size());
    for (std::uint32_t n = 0; n < count;) {
        if (!support.level(n)) {
            ++n;
            continue;
        }
        chain.clear(n);
        do {
            support.find(n, parts);
            chain.add(BeadPath(toolpath, toolpath.beads[n]).length(), parts);
            ++n;
        } while (n < count && support.level(n) && joined(toolpath, toolpath.beads[n - 1], toolpath.beads[n]));
        chain.collect(hanging);
    }
    return hanging;
}

// Makes the pieces of one bead.
class Pieces {
public:
    Pieces(const gcode::Toolpath& toolpath, double fraction, const HangingParts& hanging)
        : toolpath_(toolpath), fraction_(fraction), hanging_(hanging) {}

    // Appends the pieces of a bead with these parts in spans.
    void cut(std::uint32_t bead, std::span<const HangingPart> parts) {
        bead_ = bead;
        weights_.clear();
        const std::size_t first = pieces.size();
        if (parts.empty()) {
            add(0, 1, 0, 0);
        } else {
            length_ = BeadPath(toolpath_, toolpath_.beads[bead]).length();
            double done = 0;
            for (const HangingPart& part : parts) {
                if (part.from > done) add(done / length_, part.from / length_, 0, 0);
                addHanging(part);
                done = part.to;
            }
            if (done < length_) add(done / length_, 1, 0, 0);
        }
        if (!toolpath_.flow.empty()) divideFlow(first);
    }

    std::vector<BeadPiece> pieces;

private:
    void addHanging(const HangingPart& part) {
        const Hanging& span = hanging_.spans[part.span];
        const double step = span.length / span.pieces;
        const double after = part.before + (part.to - part.from);
        double s = part.before;
        for (double knot = std::floor(s / step) + 1; s < after; ++knot) {
            double next = knot * step;
            if (next <= s + kLeastPiece) continue;
            if (next >= after - kLeastPiece) next = after;
            const double from = part.from + (s - part.before);
            const double to = next == after ? part.to : part.from + (next - part.before);
            add(from / length_, to / length_, span.drop(s, fraction_), span.drop(next, fraction_));
            s = next;
        }
        // A bead of no length in a span only moves down.
        if (part.from == part.to) add(0, 1, span.drop(s, fraction_), span.drop(s, fraction_));
    }

    void add(double from, double to, double drop0, double drop1) {
        const gcode::Bead& bead = toolpath_.beads[bead_];
        BeadPiece piece{.bead = bead_, .from = from, .to = to, .width = bead.width, .drop0 = drop0, .drop1 = drop1};
        if (!toolpath_.flow.empty()) piece.flow = toolpath_.flow[bead_];
        if (!toolpath_.timing.empty()) piece.timing = toolpath_.timing[bead_];
        if (from > 0 || to < 1 || drop0 != drop1) {
            double width = static_cast<double>(bead.width);
            // The width changes evenly along the bead.
            width += static_cast<double>(piece.flow.widening) * (0.5 * (from + to) - 0.5);
            width = std::max(width, 0.0);
            weights_.push_back(areaOf(width) * (to - from));
            piece.flow.widening = drop0 != drop1 ? 0 : static_cast<float>((to - from) * double{piece.flow.widening});
            if (drop0 != drop1) {
                const double plan = (to - from) * length_;
                const double area = areaOf(width) * plan / std::hypot(plan, drop1 - drop0);
                width = gcode::sectionWidth(area, heightOf());
            }
            piece.width = static_cast<float>(width);
            divideTiming(piece);
        } else {
            weights_.push_back(1);
        }
        pieces.push_back(piece);
    }

    double heightOf() const { return static_cast<double>(toolpath_.runOf(toolpath_.beads[bead_]).height); }
    double areaOf(double width) const { return gcode::sectionArea(width, heightOf()); }

    // Where a bead is cut, the nozzle passes with the bead's highest speed.
    static void divideTiming(BeadPiece& piece) {
        gcode::BeadTiming& timing = piece.timing;
        timing.start += piece.from * static_cast<double>(timing.seconds);
        timing.seconds = static_cast<float>((piece.to - piece.from) * static_cast<double>(timing.seconds));
        if (piece.from > 0) timing.entry = timing.peak;
        if (piece.to < 1) timing.exit = timing.peak;
    }

    // The volume that was simulated, by the pieces' volumes; weights_ are those of the last pieces.
    void divideFlow(std::size_t first) {
        double total = 0;
        for (const double weight : weights_) total += weight;
        for (std::size_t n = 0; n < weights_.size(); ++n) {
            BeadPiece& piece = pieces[first + n];
            const double share = weights_.size() == 1 ? 1 : total > 0 ? weights_[n] / total : piece.to - piece.from;
            piece.flow.volume = static_cast<float>(share * static_cast<double>(piece.flow.volume));
        }
    }

    const gcode::Toolpath& toolpath_;
    double fraction_;
    const HangingParts& hanging_;
    std::uint32_t bead_ = 0;
    double length_ = 0;  // mm
    std::vector<double> weights_;
};

}  // namespace

SagReport sagBeads(gcode::Toolpath& toolpath, double fraction) {
    SagReport report;
    if (!(fraction > 0)) return report;
    fraction = std::min(fraction, kMostSag);
    const HangingParts hanging = findSpans(toolpath, fraction);
    if (hanging.spans.empty()) return report;
    for (const Hanging& span : hanging.spans) {
        ++report.spans;
        report.length_mm += span.length;
        report.deepest_mm = std::max(report.deepest_mm, span.drop(0.5 * span.length, fraction));
    }
    Pieces pieces(toolpath, fraction, hanging);
    pieces.pieces.reserve(toolpath.beads.size() + 16 * hanging.spans.size());
    auto part = hanging.parts.begin();
    for (std::uint32_t n = 0; n < toolpath.beads.size(); ++n) {
        const auto first = part;
        while (part != hanging.parts.end() && part->bead == n) ++part;
        pieces.cut(n, {first, part});
    }
    cutBeads(toolpath, pieces.pieces);
    return report;
}

}  // namespace stratum::deposit
