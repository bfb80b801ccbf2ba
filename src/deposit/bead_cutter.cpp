#include "deposit/bead_cutter.h"

#include "gcode/toolpath/plan_path.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace stratum::deposit {
namespace {

gcode::PlanPoint onPath(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double fraction) {
    // The ends to the bit, so that neighbours stay joined.
    if (fraction <= 0) return {bead.x0, bead.y0};
    if (fraction >= 1) return {bead.x1, bead.y1};
    if (bead.arc >= 0) {
        const gcode::PlanPath path(toolpath, bead);
        return path.at(fraction * path.length());
    }
    return {std::lerp(double{bead.x0}, double{bead.x1}, fraction),
            std::lerp(double{bead.y0}, double{bead.y1}, fraction)};
}

// Bead::arc of a straight bead of this line.
std::int32_t straightArc(std::uint32_t line) {
    return -static_cast<std::int32_t>(std::min(line, std::uint32_t{0x7fffffff}));
}

double heightAt(const gcode::Bead& bead, double fraction, double drop) {
    const double z = fraction <= 0   ? double{bead.z0}
                     : fraction >= 1 ? double{bead.z1}
                                     : std::lerp(double{bead.z0}, double{bead.z1}, fraction);
    return z - drop;
}

}  // namespace

BeadPiece wholeBead(const gcode::Toolpath& toolpath, std::uint32_t bead) {
    BeadPiece piece{.bead = bead, .width = toolpath.beads[bead].width};
    if (!toolpath.flow.empty()) piece.flow = toolpath.flow[bead];
    if (!toolpath.timing.empty()) piece.timing = toolpath.timing[bead];
    return piece;
}

BeadCutter::BeadCutter(gcode::Toolpath& toolpath, bool with_flow, std::size_t expected)
    : toolpath_(toolpath), with_flow_(with_flow) {
    beads_.reserve(expected);
    if (with_flow) flow_.reserve(expected);
    if (!toolpath.timing.empty()) timing_.reserve(expected);
}

void BeadCutter::add(const BeadPiece& piece) {
    while (changes_.size() < toolpath_.color_changes.size() &&
           toolpath_.color_changes[changes_.size()].first_bead <= piece.bead)
        changes_.push_back(static_cast<std::uint32_t>(beads_.size()));
    const gcode::Bead& source = toolpath_.beads[piece.bead];
    gcode::Bead bead = source;
    bead.width = piece.width;
    if (piece.apart) {
        bead.x0 = piece.apart->x0;
        bead.y0 = piece.apart->y0;
        bead.z0 = piece.apart->z0 - piece.drop0;
        bead.x1 = piece.apart->x1;
        bead.y1 = piece.apart->y1;
        bead.z1 = piece.apart->z1 - piece.drop1;
        bead.arc = straightArc(toolpath_.lineOf(source));
        return keep(bead, piece);
    }
    const gcode::PlanPoint start = onPath(toolpath_, source, piece.from);
    const gcode::PlanPoint end = onPath(toolpath_, source, piece.to);
    bead.x0 = start.x;
    bead.y0 = start.y;
    bead.z0 = heightAt(source, piece.from, piece.drop0);
    bead.x1 = end.x;
    bead.y1 = end.y;
    bead.z1 = heightAt(source, piece.to, piece.drop1);
    if (source.arc >= 0) {
        gcode::Arc arc = toolpath_.arcs[static_cast<std::size_t>(source.arc)];
        if (piece.to > piece.from) {
            arc.sweep *= piece.to - piece.from;
            bead.arc = static_cast<std::int32_t>(arcs_.size());
            arcs_.push_back(arc);
        } else {
            bead.arc = straightArc(arc.line);
        }
    }
    keep(bead, piece);
}

void BeadCutter::keep(const gcode::Bead& bead, const BeadPiece& piece) {
    beads_.push_back(bead);
    if (with_flow_) flow_.push_back(piece.flow);
    if (!toolpath_.timing.empty()) timing_.push_back(piece.timing);
}

void BeadCutter::finish() {
    for (std::size_t n = 0; n < toolpath_.color_changes.size(); ++n)
        toolpath_.color_changes[n].first_bead =
            n < changes_.size() ? changes_[n] : static_cast<std::uint32_t>(beads_.size());
    toolpath_.beads = std::move(beads_);
    toolpath_.arcs = std::move(arcs_);
    toolpath_.flow = std::move(flow_);
    toolpath_.timing = std::move(timing_);
}

}  // namespace stratum::deposit
