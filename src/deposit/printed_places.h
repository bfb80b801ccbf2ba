// Where in the plan something is printed, and how high: what a travel has below it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

namespace stratum::deposit {

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

}  // namespace stratum::deposit
