#include "shade/film/exact_sums.h"

#include <gtest/gtest.h>
#include <boost/multiprecision/cpp_bin_float.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace stratum {
namespace {

using shade::ExactSums;

// Wide enough for the sum of any doubles, and rounded once when it becomes one.
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<2300>>;

double oracle(const std::vector<double>& values) {
    Wide sum = 0;
    for (const double value : values) sum += Wide(value);
    return sum.convert_to<double>();
}

double sumOf(const std::vector<double>& values) {
    ExactSums sums(1);
    for (const double value : values) sums.add(0, value);
    return sums.value(0);
}

std::vector<double> randomValues(std::mt19937_64& random, int widest, std::size_t count) {
    std::uniform_int_distribution<int> exponent(-widest, widest);
    std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
    std::vector<double> values(count);
    for (double& value : values) value = std::ldexp(mantissa(random), exponent(random));
    return values;
}

TEST(ExactSums, AreRoundedOnce) {
    std::mt19937_64 random(5);
    for (const int widest : {0, 3, 60, 150, 900})
        for (std::size_t count = 1; count < 40; ++count) {
            std::vector<double> values = randomValues(random, widest, count);
            ASSERT_EQ(sumOf(values), oracle(values)) << widest << " " << count;
            // All but a little is taken away again.
            for (std::size_t n = 0; n + 1 < count; ++n) values.push_back(-values[n] * (1.0 + 1e-15));
            ASSERT_EQ(sumOf(values), oracle(values)) << widest << " " << count;
        }
}

TEST(ExactSums, HalfUnitsGoTheRightWay) {
    const double half = 0x1p-53;
    EXPECT_EQ(sumOf({1.0, half}), 1.0);
    EXPECT_EQ(sumOf({1.0, half, 0x1p-200}), 1.0 + 2 * half);
    EXPECT_EQ(sumOf({1.0, half, -0x1p-200}), 1.0);
    EXPECT_EQ(sumOf({1.0 + 2 * half, half, -0x1p-200}), 1.0 + 2 * half);
    EXPECT_EQ(sumOf({1.0 + 2 * half, half}), 1.0 + 4 * half);
}

TEST(ExactSums, DoNotDependOnOrderOrDivision) {
    std::mt19937_64 random(7);
    for (const int widest : {2, 40, 140}) {
        std::vector<double> values = randomValues(random, widest, 60);
        const double whole = sumOf(values);
        for (const std::size_t shares : {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{60}}) {
            std::shuffle(values.begin(), values.end(), random);
            ExactSums all(2);  // the place of a sum doesn't matter, either
            for (std::size_t share = 0; share < shares; ++share) {
                ExactSums sums(3);
                for (std::size_t n = share; n < values.size(); n += shares) sums.add(2, values[n]);
                all.add(1, sums, 2);
            }
            EXPECT_EQ(all.value(1), whole) << widest << " " << shares;
            EXPECT_EQ(all.value(0), 0.0);
        }
    }
}

TEST(ExactSums, RunsAddWhatOneByOneAdds) {
    std::mt19937_64 random(8);
    for (const int widest : {2, 40, 140}) {
        ExactSums one_by_one(5);
        ExactSums in_runs(5);
        for (int part = 0; part < 3; ++part) {
            ExactSums::Run<3> run(in_runs, 1);
            for (int n = 0; n < 20; ++n) {
                const std::vector<double> v = randomValues(random, widest, 3);
                run.add({v[0], v[1], v[2]});
                for (std::size_t k = 0; k < 3; ++k) one_by_one.add(1 + k, v[k]);
            }
        }
        ASSERT_EQ(in_runs.planes(), one_by_one.planes()) << widest;
        for (std::size_t k = 0; k < in_runs.planes(); ++k) EXPECT_EQ(in_runs.plane(k), one_by_one.plane(k)) << widest;
    }
}

TEST(ExactSums, OfLikeValuesNeedOnePlane) {
    ExactSums sums(1);
    for (int n = 0; n < 65536; ++n) sums.add(0, 0.7f + 1e-3f * static_cast<float>(n % 100));
    EXPECT_EQ(sums.planes(), 1u);
    sums.add(0, 1e-25);
    EXPECT_EQ(sums.planes(), 2u);
}

TEST(ExactSums, KeepWhatIsNotFinite) {
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(sumOf({1.0, infinity, 1e-30, -3.0}), infinity);
    EXPECT_EQ(sumOf({1.0, 1e-30, -infinity, 2.0}), -infinity);
    EXPECT_TRUE(std::isnan(sumOf({infinity, 1.0, -infinity, 1.0})));
    EXPECT_TRUE(std::isnan(sumOf({1.0, 1e-30, std::nan(""), 1.0})));
    EXPECT_FALSE(std::signbit(sumOf({-0.0, -0.0})));
    EXPECT_EQ(sumOf({1.0, 1e-30, -1.0, -1e-30}), 0.0);
}

}  // namespace
}  // namespace stratum
