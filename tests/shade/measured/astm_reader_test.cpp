#include "shade/measured/text_readers.h"

#include "base/error.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

std::string astmText(double unit, double phi_i) {
    std::string text = "# by hand\nNUM_POINTS 1\nVARS theta_i,phi_i,theta_s,phi_s,R,G,B\n";
    for (const double i : {0.0, 30.0, 60.0}) {
        for (int p = 0; p <= 88; p += 4) {
            for (int a = 0; a <= 180; a += 15) {
                if (p == 0 && a > 0) continue;
                const double polar = p * test::kRadians;
                const double phi = a * test::kRadians;
                const glm::dvec3 light(std::sin(i * test::kRadians), 0.0, std::cos(i * test::kRadians));
                const shade::Color f = test::knownBrdf(
                    light, {std::sin(polar) * std::cos(phi), std::sin(polar) * std::sin(phi), std::cos(polar)});
                text += fmt::format("{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g},{:.7g}\r\n", i * unit, phi_i * unit,
                                    p * unit, (a + phi_i) * unit, f.r, f.g, f.b);
            }
        }
    }
    return text;
}

TEST(Astm, ReadsRadiansAndDegrees) {
    for (const double unit : {test::kRadians, 1.0}) {
        for (const double phi_i : {0.0, 45.0}) {
            const std::string text = astmText(unit, phi_i);
            ASSERT_TRUE(shade::isAstm(text));
            const auto scan = shade::foldScan(shade::readAstm(text, "t"));
            ASSERT_EQ(scan.incidences.size(), 3u);
            ASSERT_EQ(scan.azimuths.size(), 13u) << unit << " " << phi_i;
            EXPECT_LT(test::worst(scan), 1e-3);
        }
    }
}

TEST(Astm, RefusesDamage) {
    const std::string good = astmText(1.0, 0.0);
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    EXPECT_THROW(shade::readAstm("VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n", "t"), InputError);
    EXPECT_THROW(shade::readAstm("NUM_POINTS 3\n", "t"), InputError);
    EXPECT_THROW(shade::readAstm(with(",R,G,B", ""), "t"), InputError);
    EXPECT_THROW(shade::readAstm(with(",R,G,B", ",R,G"), "t"), InputError);
    EXPECT_THROW(shade::readAstm(good.substr(0, good.size() / 2), "t"), InputError);
    try {  // a hole in the grid
        std::string text = good;
        const std::size_t at = text.find("\n30,0,40,45,");
        text.erase(at, text.find('\n', at + 1) - at);
        shade::readAstm(text, "t");
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("theta_i 30"), std::string::npos) << error.what();
    }
}

TEST(Astm, ReadingsAtThePoleAloneAreNoGrid) {
    // Their grid would have the square of their number.
    std::string text = "VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n";
    for (int n = 0; n < 30000; ++n)
        text += fmt::format("{:.6f},0,0,0,1,1,1\n0,0,0,{:.6f},1,1,1\n", 1e-4 * n * 0.5, 2e-4 * n);
    EXPECT_THROW(shade::readAstm(text, "t"), InputError);
}

TEST(Astm, RefusesAnglesThatAreNone) {
    for (const char* angle : {"1e300", "-1e9", "4000"})
        EXPECT_THROW(
            shade::readAstm(fmt::format("VARS theta_i,phi_i,theta_s,phi_s,R,G,B\n0,0,0,{},1,1,1\n", angle), "t"),
            InputError);
}

}  // namespace
}  // namespace stratum
