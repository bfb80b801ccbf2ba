#include "shade/measured/text_readers.h"

#include "base/error.h"
#include "shade/scan_checks.h"

#include <gtest/gtest.h>

namespace stratum {
namespace {

using shade::readMiniDiff;

TEST(MiniDiff, ReadsAnyOriginOfAzimuth) {
    for (const double origin : {0.0, 90.0, 180.0, 270.0}) {
        const std::string text = test::miniDiffText(origin, origin == 90.0 ? "\r\n" : "\n");
        ASSERT_TRUE(shade::isMiniDiff(text));
        const auto scan = shade::foldScan(readMiniDiff(text, "t"));
        ASSERT_EQ(scan.incidences.size(), 4u);
        EXPECT_NEAR(scan.incidences[3], 60.0 * test::kRadians, 1e-12);
        EXPECT_LT(test::worst(scan), 1e-4) << origin;
    }
}

TEST(MiniDiff, NotesAWrongTis) {
    const auto notes = [](double tis) {
        std::string all;
        for (const std::string& n : readMiniDiff(test::miniDiffText(0.0, "\n", tis), "t").notes) all += n + "\n";
        return all;
    };
    EXPECT_NE(notes(0.1).find("TIS says 0.1"), std::string::npos);
    EXPECT_NE(notes(0.1).find("by hand"), std::string::npos);
}

TEST(MiniDiff, RefusesDamage) {
    const std::string good = test::miniDiffText(0.0);
    // Cut at any place before the last matrix is whole.
    const std::size_t end = good.rfind("\nDataEnd");
    for (std::size_t n = 0; n < 60; ++n) {
        const std::size_t length = n * end / 60;
        EXPECT_THROW(readMiniDiff(good.substr(0, length), "t"), InputError) << length;
    }
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return text;
    };
    for (const std::string& text :
         {with("ScatterRadial\t46", "ScatterRadial\t99999999"), with("ScatterRadial\t46", "ScatterRadial\t45"),
          with("AOI 20", "AOI 95"), with("AOI 20", "AOI x"), with("AOI 20", "AOI 0"),
          with("Wavelength 450", "Wavelength 451"), with("Wavelength 450", "Wavelength nan")})
        EXPECT_THROW(readMiniDiff(text, "t"), InputError);
    // Angles that are stated anew after readings of others: fewer, more, between channels.
    const std::string few = "ScatterAzimuth 1\n0\n";
    const std::string many = "ScatterAzimuth 3\n0 90 180\n";
    for (const std::string& more : {few, many, "ScatterRadial 2\n0 90\n" + few, many + "ScatterRadial 3\n0 45 90\n"}) {
        std::string text = good;
        EXPECT_THROW(readMiniDiff(text.insert(text.find("DataEnd"), more), "t"), InputError) << more;
    }
    std::string other = good;
    const std::size_t block = other.rfind("\nAOI");
    other.replace(block, std::string::npos,
                  few + "ScatterRadial 2\n0 90\nAOI 60\nSide Front\nWavelength 450\nScatterType BRDF\n1 1\nDataEnd\n");
    EXPECT_THROW(readMiniDiff(other, "t"), InputError);
    // Only the back side.
    std::string back = good;
    for (std::size_t at = back.find("Front"); at != std::string::npos; at = back.find("Front"))
        back.replace(at, 5, "Back");
    EXPECT_THROW(readMiniDiff(back, "t"), InputError);
}

}  // namespace
}  // namespace stratum
