// Samples directions exactly proportional to a bilinearly interpolated map of light.
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

    /// The bin of a surface.
    /// @param normal  finite, not 0
    int bin(const glm::vec3& normal) const;
    /// @param u    uniform in [0, 1)^2
    /// @param pdf  density there per unit of area; 0 means "no sample"
    glm::dvec2 sample(int bin, const glm::dvec2& u, double& pdf) const;
    double pdf(int bin, const glm::dvec2& point) const;

    /// The tables themselves, for vector code; described at the private members.
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
    /// Weights at the corners of a cell between texel centers. Row 0 lies above the first row of centers.
    struct Corners {
        double w00, w10, w01, w11;
        double at(double x, double y) const {
            return (1.0 - y) * ((1.0 - x) * w00 + x * w10) + y * ((1.0 - x) * w01 + x * w11);
        }
    };
    Corners corners(int column, int row) const;
    void sumCells();
    void weighBlocks(const Direction& direction);
    /// Density over interpolated weight, in a cell.
    double scale(int bin, int column, int row) const;
    std::size_t blockOf(int column, int row) const {
        return static_cast<std::size_t>(row >> shift_) * block_columns_ + static_cast<std::size_t>(column >> shift_);
    }
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
