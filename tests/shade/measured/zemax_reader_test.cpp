#include "shade/measured/text_readers.h"

#include "base/error.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

/// The known surface by angles about the mirror direction; below the horizon 0.
std::string zemaxText(bool xyz) {
    std::vector<double> azimuths, radials;
    for (int a = 0; a <= 180; a += 3) azimuths.push_back(a);
    for (int r = 0; r <= 180; r += 1) radials.push_back(r);
    std::string text = "#by hand\nSource  Measured\nSymmetry  PlaneSymmetrical\n";
    text += xyz ? "SpectralContent  XYZ\n" : "SpectralContent  Monochrome\n";
    text += "ScatterType  BRDF\nSampleRotation  1\n0\nAngleOfIncidence  3\n0 30 60\n";
    text += fmt::format("ScatterAzimuth {}\n", azimuths.size()) + test::joined(azimuths, " ");
    text += fmt::format("ScatterRadial {}\n", radials.size()) + test::joined(radials, " ") + "\n";
    for (int c = 0; c < (xyz ? 3 : 1); ++c) {
        text += xyz ? fmt::format("Tristimulus{}\n", "XYZ"[c]) : "Monochrome\n";
        text += "DataBegin\n";
        for (const double aoi : {0.0, 30.0, 60.0}) {
            const double ti = aoi * test::kRadians;
            const glm::dvec3 light(std::sin(ti), 0.0, std::cos(ti));
            const glm::dvec3 mirror(-std::sin(ti), 0.0, std::cos(ti));
            const glm::dvec3 to_normal(std::cos(ti), 0.0, std::sin(ti));
            text += "TIS 0.5\n";
            for (const double a : azimuths) {
                std::vector<double> row;
                for (const double r : radials) {
                    const glm::dvec3 d =
                        std::cos(r * test::kRadians) * mirror +
                        std::sin(r * test::kRadians) * (std::cos(a * test::kRadians) * to_normal +
                                                        std::sin(a * test::kRadians) * glm::dvec3(0, 1, 0));
                    // Grey: the red channel; XYZ of a grey of that value.
                    const double white[3] = {0.9505, 1.0, 1.089};
                    row.push_back(d.z > 0.0 ? double(test::knownBrdf(light, d).r) * (xyz ? white[c] : 1.0) : 0.0);
                }
                text += test::joined(row, " ");
            }
        }
        text += "DataEnd\n";
    }
    return text;
}

TEST(Zemax, ResamplesAboutTheNormal) {
    for (const bool xyz : {false, true}) {
        const std::string text = zemaxText(xyz);
        ASSERT_TRUE(shade::isZemax(text));
        const auto scan = shade::foldScan(shade::readZemax(text, "t"));
        ASSERT_EQ(scan.incidences.size(), 3u);
        double largest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3 light(std::sin(scan.incidences[i]), 0.0, std::cos(scan.incidences[i]));
            for (std::size_t a = 0; a < scan.azimuths.size(); ++a) {
                for (std::size_t p = 0; p < 85; ++p) {
                    const double polar = scan.polars[p];
                    const double phi = scan.azimuths[a];
                    const double truth =
                        double(test::knownBrdf(light, {std::sin(polar) * std::cos(phi), std::sin(polar) * std::sin(phi),
                                                       std::cos(polar)})
                                   .r);
                    for (int c = 0; c < 3; ++c)
                        largest =
                            std::max(largest, std::abs(double(scan.values[scan.index(i, a, p)][c]) / truth - 1.0));
                }
            }
        }
        EXPECT_LT(largest, 0.02);
    }
}

TEST(Zemax, RefusesDamage) {
    const std::string good = zemaxText(false);
    for (std::size_t n = 0; n < 40; ++n)
        EXPECT_THROW(shade::readZemax(good.substr(0, n * good.rfind("DataEnd") / 41), "t"), InputError) << n;
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    EXPECT_THROW(shade::readZemax(with("ScatterType  BRDF", "ScatterType  BTDF"), "t"), InputError);
    EXPECT_THROW(shade::readZemax(with("Monochrome", "XYZ"), "t"), InputError);
    EXPECT_THROW(shade::readZemax(with("TIS 0.5", "TOS 0.5"), "t"), InputError);
}

TEST(Zemax, RefusesAnglesThatAreStatedAnew) {
    for (const bool xyz : {false, true})
        for (const char* more : {"ScatterAzimuth 2\n0 180\n", "ScatterRadial 3\n0 90 180\n", "AngleOfIncidence 1\n0\n",
                                 "AngleOfIncidence 4\n0 10 20 30\n", "ScatterAzimuth 400\n"}) {
            std::string text = zemaxText(xyz) + more;
            if (std::string(more).ends_with(" 400\n"))
                for (int n = 0; n < 400; ++n) text += std::to_string(0.4 * n) + " ";
            EXPECT_THROW(shade::readZemax(text + "\n", "t"), InputError) << more;
        }
}

TEST(Zemax, RefusesChannelsOfOtherSizes) {
    std::string text = zemaxText(true);
    const std::size_t second = text.find("DataBegin", text.find("DataBegin") + 1);
    text.insert(second, "AngleOfIncidence 1\n0\n");
    EXPECT_THROW(shade::readZemax(text, "t"), InputError);
}

}  // namespace
}  // namespace stratum
