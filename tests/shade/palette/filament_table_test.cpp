#include "shade/palette/filament_table.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace stratum::shade {
namespace {

constexpr const char* kHead = "manufacturer\tmaterial\tname\thex\tfinish\ttranslucent\tpattern\n";

TEST(FilamentTable, ReadsRows) {
    const auto table = parseFilaments(std::string(kHead) +
                                          "A\tPLA\tJet Black\t0f0F10\t\t\t\n"
                                          "B\tPETG\tSilk Gold\tC49954\tglossy\t\t\n"
                                          "B\tPLA\tStar\tABC\tglossy\t\tsparkle\r\n"
                                          "B\tPLA\tTwo\tFF0000,00FF00\tmatte\t\t\n"
                                          "B\tPLA\tClear\t00FFFFFE\tmatte\tTrue\t\n"
                                          "B\tPLA\tBlau\t2437b988\tglossy\tTrue\t\n",
                                      "t");
    ASSERT_EQ(table.size(), 5U);  // without the one of two colors
    EXPECT_EQ(fullName(table[0]), "A PLA Jet Black");
    EXPECT_EQ(table[0].color, 0x0f0f10U);
    EXPECT_EQ(table[0].finish, Finish::plain);
    EXPECT_EQ(table[1].finish, Finish::silk);
    EXPECT_EQ(table[2].finish, Finish::glitter);
    EXPECT_EQ(table[2].color, 0xaabbccU);
    EXPECT_EQ(table[3].finish, Finish::matte);
    EXPECT_EQ(table[3].color, 0xfffffeU);  // alpha first
    EXPECT_EQ(table[4].finish, Finish::glossy);
    EXPECT_EQ(table[4].color, 0x2437b9U);  // alpha last
}

TEST(FilamentTable, RefusesDamage) {
    EXPECT_THROW((void)parseFilaments(std::string(kHead) + "A\tPLA\tJet\t0f0f10\n", "t"), InputError);
    EXPECT_THROW((void)parseFilaments(std::string(kHead) + "A\tPLA\tJet\tred\t\t\t\n", "t"), InputError);
}

TEST(FilamentTable, WordsAreWithoutAccentsAndSigns) {
    using Words = std::vector<std::string>;
    EXPECT_EQ(wordsOf("PolyLite™ PLA+ Grün (Matt)"), (Words{"polylite", "pla+", "grun", "matt"}));
    EXPECT_EQ(wordsOf("  \xff\xfe "), Words());
    EXPECT_EQ(wordsOf("weiß"), Words{"weiss"});
}

TEST(FilamentTable, TheProjectsOwn) {
    const std::vector<Filament>& table = filaments();
    EXPECT_GT(table.size(), 2900U);
    const auto count = [&](Finish finish) {
        return std::count_if(table.begin(), table.end(), [finish](const Filament& f) { return f.finish == finish; });
    };
    EXPECT_GT(count(Finish::silk), 100);
    EXPECT_GT(count(Finish::matte), 100);
    EXPECT_GT(count(Finish::glitter), 40);
    for (const Filament& filament : table) EXPECT_FALSE(filament.words.empty() || filament.color > 0xffffffU);
}

}  // namespace
}  // namespace stratum::shade
