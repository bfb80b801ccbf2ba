#include "deposit/lay_flow.h"

#include "deposit/sag.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace stratum::deposit {
namespace {

// The width may grow by this share of the length: beyond 45 degrees to each side one end would hide the other.
constexpr double kSteepestTaper = 1.0;
constexpr double kMostHeights = 100;    // a wider part is a mistake, as a wider bead is; the rest is purged
constexpr double kStringSteps = 16;     // of a string that hangs
constexpr double kMostShortened = 0.9;  // of a part's length

// Half the width of a rectangle of the same area and height as a stadium, less half the stadium's width, mm.
double roundedOff(double height) { return 0.5 * height * (1 - std::numbers::pi / 4); }

// The reader may find after the motion was recorded that the filament is another one.
double filamentScale(const FlowRecord& record, const gcode::Toolpath& toolpath) {
    constexpr double kAnother = 1.5;
    const double scale = std::numbers::pi / 4 * toolpath.filament_diameter * toolpath.filament_diameter /
                         (record.filament_area > 0 ? record.filament_area : 1);
    const double needed = record.fed_to_beads > 0 ? toolpath.extruded_mm3 / record.fed_to_beads : 1;
    return needed > kAnother && std::abs(needed - scale) < 0.1 * scale ? scale : 1;
}

// mm^3 that a path's end adds, for it is half a disc: the half of a stadium turned about its middle, or half a ball.
double endVolume(double width, double height) {
    constexpr double kPi = std::numbers::pi;
    const double radius = 0.5 * std::min(width, height);
    const double flat = 0.5 * std::max(width - height, 0.0);
    return 0.5 * kPi * (flat * flat * 2 * radius + kPi * radius * radius * flat + 4.0 / 3 * radius * radius * radius);
}

class FlowPieces {
public:
    FlowPieces(const FlowRecord& record, const gcode::Toolpath& toolpath,
               const std::function<void(const BeadPiece&)>& lay)
        : record_(record), toolpath_(toolpath), lay_(lay), scale_(filamentScale(record, toolpath)) {}

    void run() {
        for (const FlowPart& part : record_.parts) {
            addSpots(part.bead, false);
            addStrings(part.bead);
            addPart(part);
        }
        addSpots(0xffffffff, true);
        addStrings(0xffffffff);
        report_.purged += record_.purged * scale_ + carried_;
        report_.laid = record_.laid * scale_;
        report_.fed = record_.fed * scale_;
        report_.in_nozzle = report_.fed - report_.laid;
        report_.longest_advance = record_.longest_advance;
        report_.beads = toolpath_.beads.size();
    }

    const FlowReport& report() const { return report_; }

private:
    double heightOf(std::uint32_t bead) const {
        return static_cast<double>(toolpath_.runOf(toolpath_.beads[bead]).height);
    }

    // All spots up to the start of this bead, or up to its end.
    void addSpots(std::uint32_t bead, bool at_end) {
        for (; next_spot_ < record_.spots.size(); ++next_spot_) {
            const FlowSpot& spot = record_.spots[next_spot_];
            if (spot.bead > bead || (spot.bead == bead && spot.at_end && !at_end)) return;
            addStrings(spot.bead);
            addDisc(spot);
        }
    }

    // All strings after earlier beads than this one.
    void addStrings(std::uint32_t bead) {
        for (; next_string_ < record_.strings.size() && record_.strings[next_string_].bead < bead; ++next_string_)
            addString(record_.strings[next_string_]);
    }

    // It hangs as a span does, in steps of an even part of its length.
    void addString(const FlowString& string) {
        const double sag = std::min(toolpath_.deposit.sag, kMostSag);
        const double length = string.to - string.from;
        const bool hangs = sag > 0 && string.span > 0;
        const double height = heightOf(string.bead);
        const int pieces = hangs ? static_cast<int>(std::ceil(kStringSteps * length / string.span)) : 1;
        const double seconds = string.seconds / pieces;
        for (int n = 0; n < pieces; ++n) {
            const double begin = static_cast<double>(n) / pieces;
            const double end = static_cast<double>(n + 1) / pieces;
            BeadPiece piece;
            piece.bead = string.bead;
            piece.apart = {std::lerp(string.x0, string.x1, begin), std::lerp(string.y0, string.y1, begin), string.z,
                           std::lerp(string.x0, string.x1, end),   std::lerp(string.y0, string.y1, end),   string.z};
            if (hangs) {
                piece.drop0 = sagDrop(string.span, string.from + begin * length, sag);
                piece.drop1 = sagDrop(string.span, string.from + end * length, sag);
            }
            const double path = std::hypot(length / pieces, piece.drop1 - piece.drop0);
            const double flow = string.volume * scale_ / pieces;
            const double volume = std::min(flow, gcode::sectionArea(kMostHeights * height, height) * path);
            piece.width = static_cast<float>(gcode::sectionWidth(volume / path, height));
            piece.flow.volume = static_cast<float>(volume);
            piece.flow.rate = seconds > 0 ? static_cast<float>(volume / seconds) : 0;
            const float speed = seconds > 0 ? static_cast<float>(path / seconds) : 0;
            piece.timing = {string.start + begin * string.seconds, static_cast<float>(seconds), speed, speed, speed};
            lay_(piece);
            report_.in_strings += volume;
            report_.purged += flow - volume;
        }
        if (string.from == 0) ++report_.strings;
        report_.strings_mm += length;
    }

    void addPart(const FlowPart& part) {
        const gcode::Bead& bead = toolpath_.beads[part.bead];
        const double length = gcode::beadLength(toolpath_, bead) * (part.to - part.from);
        const double height = heightOf(part.bead);
        const double flow = part.volume * scale_ + carried_;
        const double volume = std::min(flow, gcode::sectionArea(kMostHeights * height, height) * length);
        const double width = length > 0 ? gcode::sectionWidth(volume / length, height) : 0;
        if (!(width >= kThinnestThread)) {
            carried_ = flow;
            return;
        }
        carried_ = 0;
        report_.purged += flow - volume;
        BeadPiece piece;
        piece.bead = part.bead;
        piece.from = part.from;
        piece.to = part.to;
        shortenEnds(part, volume, endVolume(width, height), piece);
        double widening = 0;
        if (width > height && bead.arc < 0 && bead.z0 == bead.z1) {
            const double most = std::min(2 * (width - height),
                                         kSteepestTaper * length * (piece.to - piece.from) / (part.to - part.from));
            widening = std::clamp(part.growth * scale_ / height, -most, most);
        }
        piece.width = static_cast<float>(width);
        piece.flow.volume = static_cast<float>(volume);
        piece.flow.rate = part.seconds > 0 ? static_cast<float>(volume / part.seconds) : 0;
        piece.flow.widening = static_cast<float>(widening);
        const float speed = part.seconds > 0 ? static_cast<float>(length / part.seconds) : 0;
        piece.timing = {part.start, static_cast<float>(part.seconds), speed, speed, speed};
        lay_(piece);
        report_.in_parts += volume;
        ++report_.parts;
    }

    // An open path ends where the volume is that of its flow: the half discs at its ends are taken from its length,
    // unless a spot fills them.
    void shortenEnds(const FlowPart& part, double volume, double end_volume, BeadPiece& piece) {
        const double share = (part.to - part.from) / volume;
        const auto missing = [&](double spot) { return share * std::max(end_volume - spot, 0.0); };
        double start = part.begins ? missing(start_spot_) : 0;
        double end = 0;
        if (part.ends) {
            const bool spot = next_spot_ < record_.spots.size() && record_.spots[next_spot_].bead == part.bead &&
                              record_.spots[next_spot_].at_end;
            end = missing(spot ? record_.spots[next_spot_].volume * scale_ : 0);
        }
        const double most = kMostShortened * (part.to - part.from);
        if (start + end > most) {
            const double fits = most / (start + end);
            start *= fits;
            end *= fits;
        }
        piece.from += start;
        piece.to -= end;
        start_spot_ = 0;
    }

    void addDisc(const FlowSpot& spot) {
        const double volume = spot.volume * scale_;
        if (volume > kMostInDisc) {
            report_.purged += volume;
            return;
        }
        const double height = heightOf(spot.bead);
        const double rounded = roundedOff(height);
        // The bead's commanded width: what really lies there changes fast.
        const double half = std::max(0.5 * static_cast<double>(toolpath_.beads[spot.bead].width) - rounded, 0.0);
        const double end = endVolume(static_cast<double>(toolpath_.beads[spot.bead].width), height);
        if (!spot.inside && !spot.at_end) start_spot_ = volume;
        const double beyond = spot.inside ? volume : volume - end;
        BeadPiece piece;
        piece.bead = spot.bead;
        piece.from = piece.to = spot.at_end ? 1 : 0;
        piece.width = static_cast<float>(2 * (discRadius(half, std::max(beyond, 0.0) / height, spot.inside) + rounded));
        piece.flow.volume = static_cast<float>(volume);
        piece.timing.start = spot.time;
        lay_(piece);
        report_.in_discs += volume;
        ++report_.discs;
    }

    const FlowRecord& record_;
    const gcode::Toolpath& toolpath_;
    const std::function<void(const BeadPiece&)>& lay_;
    const double scale_;
    FlowReport report_;
    std::size_t next_spot_ = 0;
    std::size_t next_string_ = 0;
    double carried_ = 0;     // mm^3, of threads too thin
    double start_spot_ = 0;  // mm^3, at the begin of the next part
};

}  // namespace

double discRadius(double half_width, double area, bool inside) {
    const auto added = [&](double radius) {
        const double angle = std::acos(std::min(half_width / radius, 1.0));
        const double beside = radius * radius * (2 * angle - std::sin(2 * angle));
        if (inside) return beside;
        return 0.5 * (std::numbers::pi * (radius * radius - half_width * half_width) + beside);
    };
    double low = std::max(half_width, 1e-6);
    double high = 2 * low;
    while (added(high) < area) high *= 2;
    constexpr int kHalvings = 50;
    for (int n = 0; n < kHalvings; ++n) {
        const double middle = 0.5 * (low + high);
        (added(middle) < area ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

FlowReport layFlow(const FlowRecord& record, const gcode::Toolpath& toolpath,
                   const std::function<void(const BeadPiece&)>& lay) {
    FlowPieces pieces(record, toolpath, lay);
    pieces.run();
    return pieces.report();
}

}  // namespace stratum::deposit
