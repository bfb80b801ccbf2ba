// Every case of the stability study is a test of its own.
#include "study/study.h"

#include "scratch_folder.h"
#include "study/stability/stability_case.h"

#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <ostream>
#include <set>

namespace stratum::study {

// Found by name: GoogleTest shows parameters of failed tests.
void PrintTo(const StabilityCase& test, std::ostream* out) { *out << test.family << ", " << test.name; }

namespace {

class Stability : public testing::TestWithParam<StabilityCase> {};

TEST_P(Stability, Holds) {
    const StabilityCase& test = GetParam();
    const double measured = test.measure();
    EXPECT_EQ(verdictOn(test, measured), "passed") << test.name << ": " << test.quantity << " is " << measured
                                                   << ", tolerance " << test.tolerance << ": " << test.why;
}

std::string testName(const testing::TestParamInfo<StabilityCase>& info) {
    std::string name = info.param.family + "_";
    for (const char c : info.param.name) {
        if (std::isalnum(static_cast<unsigned char>(c)) != 0)
            name += c;
        else if (c == '.')
            name += "p";
        else if (c == '-' && name.back() == 'e')
            name += "m";
        else if (name.back() != '_')
            name += '_';
    }
    return name;
}

INSTANTIATE_TEST_SUITE_P(Cases, Stability, testing::ValuesIn(stabilityCases()), testName);

TEST(StabilityCases, CoverTheirFamiliesWithNamesOfTheirOwn) {
    std::set<std::string> names;
    std::set<std::string> families;
    for (const StabilityCase& test : stabilityCases()) {
        EXPECT_TRUE(names.insert(test.family + "/" + test.name).second) << test.name;
        families.insert(test.family);
        EXPECT_FALSE(test.why.empty());
        EXPECT_GE(test.tolerance, 0);
    }
    EXPECT_GE(names.size(), 55U);
    EXPECT_EQ(families, (std::set<std::string>{"field", "light", "rays"}));
}

TEST(StabilityCases, ANumberThatIsNoneDoesNotPass) {
    StabilityCase test;
    test.tolerance = 1;
    EXPECT_EQ(verdictOn(test, 1), "passed");
    EXPECT_EQ(verdictOn(test, 1.001), "failed");
    EXPECT_EQ(verdictOn(test, std::nan("")), "failed");
}

}  // namespace
}  // namespace stratum::study
