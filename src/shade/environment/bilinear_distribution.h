// Tables to draw directions exactly in proportion to a bilinearly interpolated map of light.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <functional>
#include <vector>

namespace stratum::shade {

/// The largest double below 1.
inline constexpr double kBelowOne = 0x1.fffffffffffffp-1;

/// A density on the latitude-longitude square [0, 1)^2 that is the bilinear interpolation of weights at texel centers
/// (periodic in u, constant beyond the first and last row) times, per row of cells, the mean sine of the polar angle.
/// The ratio of the interpolated weight to the density, per steradian, is thus nearly constant: samples have hardly any
/// variance of their own, even at the edges of a texel that is 10^5 times brighter than its neighbours.
///
/// With a function from the square to the sphere, there is a density for each of NormalBins: blocks of cells, some
/// 32 x 17 of them, are weighted by the cosine to the bin's normals as well. A surface then samples only the hemisphere
/// above it, and mostly directions of normal incidence.
class BilinearDistribution {
public:
    /// From the square to unit directions, in the space of the normals.
    using Direction = std::function<glm::vec3(const glm::dvec2& place)>;

    /// @param weights    columns * rows values at texel centers, row by row, >= 0 and finite. All zero means uniform.
    /// @param direction  none: one bin, without cosines
    BilinearDistribution(std::vector<float> weights, int columns, int rows, const Direction& direction = {});

    /// The tables themselves, which sampleMap() draws from; described at the private members.
    struct View {
        /// Numbers that may be read, and mean nothing, behind the last of running sums: vectors need no shorter end.
        static constexpr std::size_t kPadding = 16;
        int columns, rows;
        unsigned shift;
        std::size_t block_columns, block_rows, bins;
        const float* weights;
        const double* sines;
        const float *rows_in_block, *cells_in_block;
        const double* block_weights;
        const double* row_sums;
        const float *block_sums, *row_scales;
    };
    View view() const {
        return {columns_,
                rows_,
                shift_,
                block_columns_,
                block_rows_,
                bins_,
                weights_.data(),
                sines_.data(),
                rows_in_block_.data(),
                cells_in_block_.data(),
                block_weights_.data(),
                row_sums_.data(),
                block_sums_.data(),
                row_scales_.data()};
    }

private:
    /// The interpolated weight in the middle of a cell between texel centers. Row 0 lies above the first row of
    /// centers.
    double middleOf(int column, int row) const;
    void sumCells();
    void weighBlocks(const Direction& direction);
    std::size_t side() const { return std::size_t{1} << shift_; }

    int columns_, rows_;
    unsigned shift_ = 0;  // a block has 2^shift cells a side
    std::size_t block_columns_ = 1, block_rows_ = 1, bins_ = 1;
    std::vector<float> weights_;
    std::vector<double> sines_;  // of the rows of cells, mean inside the square
    // Running sums, each without its leading 0 and with 1 at its end: of a block's rows; of the cells of those.
    std::vector<float> rows_in_block_, cells_in_block_;
    std::vector<double> block_weights_;  // sums of the cells' weights times sines
    // By bin: running sums of the rows of blocks, and in each row of the blocks.
    std::vector<double> row_sums_;
    std::vector<float> block_sums_;
    std::vector<float> row_scales_;  // by bin and row: share of the row over the last of its block_sums_
};

}  // namespace stratum::shade
