// The surplus of a layer, spread to where outlines can move out and tops can rise: the arithmetic of swell_field.h.
#pragma once

#include "voxelize/swell/swell_field.h"
#include "voxelize/swell/tent.h"

#include <vector>

namespace stratum::voxelize {

/// A square of nodes of one layer, row by row: sums of tents, as TileSums has them. Floats: their rounding is a
/// millionth of what a node holds.
struct SpreadNodes {
    int edge = 0;
    std::vector<float> surplus;
    std::array<std::vector<float>, TileSums::kLevels> gain;
    std::vector<float> open;

    explicit SpreadNodes(int the_edge);
    void clear(const NodeBox& where);
};

/// By node, mm^3. Together they are the surplus.
struct Spread {
    std::vector<float> given;   ///< at most the node's gain at kMostSwell
    std::vector<float> raised;  ///< at most its open area times `most_rise`
    std::vector<float> left;    ///< what has no place in this layer; below 0 where it holds more than was fed
};

/// Nodes on each side of those whose swell is wanted: what is given to one depends on what those within kFar are left
/// with, and on what those have room for that they may send it to.
constexpr int kSpreadHalo = 2 * (kNear + kFar) + kUp;
static_assert(kUp <= 2 * kNear);

/// Spreads layer after layer. Of one thread.
class Spreading {
public:
    /// `edge`: nodes along each edge of the square.
    explicit Spreading(int edge);

    /// Right for the nodes of `wanted`, if all within kSpreadHalo of them are in the square or 0. `box`: of all nodes
    /// that are not 0.
    /// `most_rise`: mm. Valid until the next call.
    const Spread& spread(const SpreadNodes& nodes, const NodeBox& box, const NodeBox& wanted, double most_rise);

private:
    enum class Sign : unsigned char { surplus, lack, both };
    /// What the nodes of `to` are sent for each mm^3, or mm^2, of their `places`: each node sends what it has left, if
    /// that is of the sign, in proportion to the places within `reach` and a tent. Without any, it stays.
    void send(const std::vector<float>& places, int reach, Sign sign, const NodeBox& to, std::vector<float>& sums);
    void moveOut(const std::vector<float>& most, int reach, bool take_back, const NodeBox& to);
    void raise(const std::vector<float>& open, float most_height, const NodeBox& to);
    template <typename Visit>
    void forEach(const NodeBox& box, Visit visit) const;

    const int edge_;
    Tent tent_;
    NodeBox box_;
    Spread spread_;
    std::vector<float> room_, around_, offered_, placed_, taken_;
};

/// The swell (mm at a settlingScale() of 1) that gains `given` at node `n`.
double swellThatGains(const SpreadNodes& nodes, std::size_t n, double given);

}  // namespace stratum::voxelize
