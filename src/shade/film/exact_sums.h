// Sums without rounding, so that it does not matter in which order and by how many processes they are added up.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace stratum::shade {

/// Many sums of doubles, each exact: of the same values it is the same in any order, and so is a sum of sums.
///
/// A sum is kept as several doubles that add up to it, one in each plane: adding to a plane leaves a rounding error,
/// which is a double itself and is added to the next plane (D. Knuth, TAOCP 2, 4.2.2). A plane is made when some sum
/// needs it. Samples of a pixel mostly need one; widely different ones, two. Exact as long as no sum comes near 1e308.
class ExactSums {
public:
    ExactSums() = default;
    explicit ExactSums(std::size_t count) : first_(count) {}

    std::size_t size() const { return first_.size(); }

    void add(std::size_t n, double value) {
        const double error = addTo(first_[n], value);
        if (std::abs(error) > 0.0) carry(n, error);  // not if the sum is infinite or NaN, which it stays
    }
    /// Adds another sum.
    void add(std::size_t n, const ExactSums& other, std::size_t m) {
        add(n, other.first_[m]);
        for (const std::vector<double>& plane : other.more_) add(n, plane[m]);
    }
    /// The double that is nearest to the sum; of two, the even one.
    double value(std::size_t n) const { return more_.empty() ? first_[n] : rounded(n); }

    std::size_t planes() const { return 1 + more_.size(); }
    /// For files: the doubles of a plane, whose sums over the planes are the sums.
    std::vector<double>& plane(std::size_t k) { return k == 0 ? first_ : more_[k - 1]; }
    const std::vector<double>& plane(std::size_t k) const { return k == 0 ? first_ : more_[k - 1]; }
    /// For files: planes of zeros, until there are so many.
    void growTo(std::size_t planes) { more_.resize(planes - 1, std::vector<double>(size())); }

    /// Adds many values to each of kCount sums that follow each other, faster than add(): the sums stay in registers.
    /// Nobody else may add to them or read them until the run is destroyed.
    template <std::size_t kCount>
    class Run {
    public:
        Run(ExactSums& sums, std::size_t first) : sums_(sums), first_(first) {
            for (std::size_t k = 0; k < kCount; ++k) kept_[k] = sums.first_[first + k];
        }
        ~Run() {
            for (std::size_t k = 0; k < kCount; ++k) sums_.first_[first_ + k] = kept_[k];
        }
        Run(const Run&) = delete;
        Run& operator=(const Run&) = delete;

        /// values[k] to the sum number first + k.
        void add(const std::array<double, kCount>& values) {
            std::array<double, kCount> errors;
            std::uint64_t bits = 0;
            for (std::size_t k = 0; k < kCount; ++k) {
                errors[k] = addTo(kept_[k], values[k]);
                bits |= std::bit_cast<std::uint64_t>(errors[k]);
            }
            if (bits << 1 == 0) return;  // all are 0 or -0
            for (std::size_t k = 0; k < kCount; ++k)
                if (std::abs(errors[k]) > 0.0) sums_.carry(first_ + k, errors[k]);
        }

    private:
        ExactSums& sums_;
        std::size_t first_;
        std::array<double, kCount> kept_;
    };

private:
    /// Adds to one double; returns what the rounding took away.
    static double addTo(double& sum, double value) {
        const double before = sum;
        sum = before + value;
        const double added = sum - before;
        return (before - (sum - added)) + (value - added);
    }
    void carry(std::size_t n, double error);
    double rounded(std::size_t n) const;

    std::vector<double> first_;  // apart from the others: mostly the only one
    std::vector<std::vector<double>> more_;
};

}  // namespace stratum::shade
