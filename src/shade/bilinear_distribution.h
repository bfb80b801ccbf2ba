// Drawing directions exactly as a map of light, interpolated between its texels, is bright.
#pragma once

#include <glm/vec2.hpp>

#include <cstddef>
#include <vector>

namespace stratum::shade {

/// A density on the latitude-longitude square [0, 1)^2 that is the bilinear interpolation of weights at texel centres
/// (round in u, constant beyond the first and last row) times, per row of cells, the mean sine of the polar angle.
/// The quotient of the interpolated weight and the density, per steradian, is thus nearly the same everywhere: what is
/// drawn has hardly any noise of its own, also on the edges of a texel that is 10^5 times brighter than its neighbours.
class BilinearDistribution {
public:
    /// @param weights  columns * rows values at texel centres, row by row, >= 0 and finite. All zero means uniform.
    BilinearDistribution(std::vector<float> weights, int columns, int rows);

    /// @param u    uniform in [0, 1)^2
    /// @param pdf  density there per unit of area; 0 means "no sample"
    glm::dvec2 sample(const glm::dvec2& u, double& pdf) const;
    double pdf(const glm::dvec2& point) const;

private:
    /// Weights at the corners of a cell between texel centres. Row 0 lies above the first row of centres.
    struct Corners {
        double w00, w10, w01, w11;
    };
    Corners corners(int column, int row) const;

    int columns_, rows_;
    std::vector<float> weights_;
    std::vector<double> sums_;          // per row of cells: columns + 1 running sums of the cells' weights
    std::vector<double> row_sums_;      // rows + 2 running sums of the rows' weights
    std::vector<double> sines_;         // of the rows of cells, mean inside the square
    int first_row_ = 1, last_row_ = 0;  // of cells that hold anything: a sun is in few of them
};

}  // namespace stratum::shade
