#include "deposit/bead_cutter.h"

#include "deposit/bead_path.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace stratum::deposit {
namespace {

gcode::PlanPoint onPath(const gcode::Toolpath& toolpath, const gcode::Bead& bead, double fraction) {
    // The ends to the bit, so that neighbours stay joined.
    if (fraction <= 0) return {bead.x0, bead.y0};
    if (fraction >= 1) return {bead.x1, bead.y1};
    if (bead.arc >= 0) {
        const BeadPath path(toolpath, bead);
        return path.at(fraction * path.length());
    }
    return {std::lerp(double{bead.x0}, double{bead.x1}, fraction),
            std::lerp(double{bead.y0}, double{bead.y1}, fraction)};
}

double heightAt(const gcode::Bead& bead, double fraction, double drop) {
    const double z = fraction <= 0   ? double{bead.z0}
                     : fraction >= 1 ? double{bead.z1}
                                     : std::lerp(double{bead.z0}, double{bead.z1}, fraction);
    return z - drop;
}

}  // namespace

void cutBeads(gcode::Toolpath& toolpath, std::span<const BeadPiece> pieces) {
    std::vector<gcode::Bead> beads;
    std::vector<gcode::Arc> arcs;
    std::vector<gcode::BeadFlow> flow;
    std::vector<gcode::BeadTiming> timing;
    beads.reserve(pieces.size());
    if (!toolpath.flow.empty()) flow.reserve(pieces.size());
    if (!toolpath.timing.empty()) timing.reserve(pieces.size());
    auto change = toolpath.color_changes.begin();
    for (const BeadPiece& piece : pieces) {
        for (; change != toolpath.color_changes.end() && change->first_bead <= piece.bead; ++change)
            change->first_bead = static_cast<std::uint32_t>(beads.size());
        const gcode::Bead& source = toolpath.beads[piece.bead];
        gcode::Bead bead = source;
        bead.width = piece.width;
        const gcode::PlanPoint start = onPath(toolpath, source, piece.from);
        const gcode::PlanPoint end = onPath(toolpath, source, piece.to);
        bead.x0 = start.x;
        bead.y0 = start.y;
        bead.z0 = heightAt(source, piece.from, piece.drop0);
        bead.x1 = end.x;
        bead.y1 = end.y;
        bead.z1 = heightAt(source, piece.to, piece.drop1);
        if (source.arc >= 0) {
            gcode::Arc arc = toolpath.arcs[static_cast<std::size_t>(source.arc)];
            if (piece.to > piece.from) {
                arc.sweep *= piece.to - piece.from;
                bead.arc = static_cast<std::int32_t>(arcs.size());
                arcs.push_back(arc);
            } else {
                bead.arc = -static_cast<std::int32_t>(std::min(arc.line, std::uint32_t{0x7fffffff}));
            }
        }
        beads.push_back(bead);
        if (!toolpath.flow.empty()) flow.push_back(piece.flow);
        if (!toolpath.timing.empty()) timing.push_back(piece.timing);
    }
    for (; change != toolpath.color_changes.end(); ++change)
        change->first_bead = static_cast<std::uint32_t>(beads.size());
    toolpath.beads = std::move(beads);
    toolpath.arcs = std::move(arcs);
    toolpath.flow = std::move(flow);
    toolpath.timing = std::move(timing);
}

}  // namespace stratum::deposit
