// Makes strings of what oozes on travels: threads between the places that have plastic below them.
//
// A travel is cut into short pieces, with what flows out on each (flow_recorder.h). Neighbouring pieces over air, thick
// enough to hold, are a string. It begins over the plastic from which the nozzle leaves and ends where it is over
// plastic again, where the next path begins, or where it becomes thinner than kThinnestThread: there it breaks, and
// what flows out after it stays at the nozzle.
#pragma once

#include "deposit/flow_record.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

namespace stratum::deposit {

// Where in the plan something is printed, and how high: what a travel has below it.

/// A place of a travel with less air than this below it is over plastic, or over the bed: what oozes there lies down,
/// mm.
constexpr double kLeastAir = 1;

/// A grid of the plan with the highest top in each cell, filled as the print goes on. Not re-entrant.
class PrintedPlaces {
public:
    /// mm, of a cell.
    static constexpr double kCell = 0.25;
    /// A print over more of the plan than this, 4 m^2, has no air: travels over it have plastic below them.
    static constexpr std::size_t kMostTiles = 250000;

    /// A line is printed, mm: of this half width, with its top at z.
    void add(double x0, double y0, double x1, double y1, double z, double half_width);
    /// Whether there is less than kLeastAir between z (mm) at this place and what is below it.
    bool under(double x, double y, double z);

private:
    static constexpr int kSide = 16;  // cells along a tile
    using Tile = std::array<float, static_cast<std::size_t>(kSide) * kSide>;

    /// The cell at a place; of a tile that is not there, nothing unless it is to be made.
    float* cell(double x, double y, bool make);

    std::unordered_map<std::uint64_t, Tile> tiles_;
    std::uint64_t last_key_ = 0;
    Tile* last_ = nullptr;
    bool full_ = false;
};

/// A shorter gap has no string, mm, in the plan: its plastic stays with what is beside it.
constexpr double kShortestString = 1;

/// Lengths of pieces that are handed in, about, mm.
constexpr double kOozeStep = 0.2;

class StringRecorder {
public:
    /// What flows out on a straight piece of a travel.
    struct Ooze {
        double x0, y0, x1, y1;  // mm
        double volume;          // mm^3
        double start, seconds;  // s
        std::size_t move;       // above 0; pieces of one move have one direction
    };
    /// What does not become strings, mm^3.
    struct Rest {
        double before = 0;  ///< laid where the travel begins
        double after = 0;   ///< laid where the next path begins
    };

    /// A line is printed, as PrintedPlaces::add() has it.
    void print(double x0, double y0, double x1, double y1, double z, double half_width);
    /// The next piece of a travel after this bead.
    void ooze(const Ooze& piece, std::uint32_t bead);
    /// Whether the string of this travel broke: what flows out is no longer laid along it.
    bool broken() const { return broken_; }
    /// The travel ends. Its strings are in the record.
    Rest finish(FlowRecord& record);

private:
    struct Part {
        Ooze ooze;
        double length;  // mm
    };

    void leave(double volume) { (strings_.empty() ? rest_.before : rest_.after) += volume; }
    void close(bool held);

    PrintedPlaces places_;
    double z_ = 0;  // mm, of the last line
    std::uint32_t bead_ = 0;
    // Of this travel:
    std::vector<Part> run_;            // over air, up to now
    std::vector<FlowString> strings_;  // pieces of those that are whole
    Rest rest_;
    bool broken_ = false;
};

}  // namespace stratum::deposit
