#include "march/brick/brick_projection.h"

namespace stratum::march {

BrickProjection projectBricks(const BrickGrid& grid, int axis) {
    constexpr int kMacro = BrickGrid::kMacroEdge / BrickGrid::kBrickEdge;
    const auto bricks = [&grid](int a) {
        return static_cast<std::size_t>(grid.size()[static_cast<std::size_t>(a)] / BrickGrid::kBrickEdge);
    };
    const int up = axis == 2 ? 1 : 2;
    BrickProjection result;
    result.width = bricks(0);
    result.height = bricks(up);
    result.listed.resize(result.width * result.height);
    result.made.resize(result.listed.size());
    for (std::size_t x = 0; x < bricks(0); ++x)
        for (std::size_t y = 0; y < bricks(1); ++y)
            for (std::size_t z = 0; z < bricks(2); ++z) {
                const int at[3] = {static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
                const MacroCell& macro = grid.macroCell(at[0] / kMacro, at[1] / kMacro, at[2] / kMacro);
                const int in[3] = {at[0] % kMacro, at[1] % kMacro, at[2] % kMacro};
                if ((macro.bricks >> Mask64::bit(in[0], in[1], in[2]) & 1) == 0) continue;
                const std::size_t row = result.height - 1 - (up == 1 ? y : z);
                const std::size_t pixel = row * result.width + x;
                ++result.listed[pixel];
                if (grid.cache().of(BrickGrid::brickIndex(macro, in[0], in[1], in[2])) != 0) ++result.made[pixel];
            }
    return result;
}

}  // namespace stratum::march
