#include "shade/palette/finish_words.h"

#include "shade/palette/color_name.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace stratum::shade {
namespace {

TEST(FinishWords, SayHowAFilamentLooks) {
    const std::vector<std::pair<const char*, Finish>> names = {
        {"Prusament PLA Galaxy Black", Finish::glitter},
        {"Generic PLA Glitter Red @MK4", Finish::glitter},
        {"Bambu PLA Sparkle @BBL X1C 0.4 nozzle", Finish::glitter},
        {"Silk Galaxy Blue", Finish::glitter},
        {"eSUN PLA Silk+ Gold", Finish::silk},
        {"SILK", Finish::silk},
        {"Bambu PLA Silk @BBL P1S", Finish::silk},
        {"Bambu PLA Matte", Finish::matte},
        {"PolyTerra Matt Blue", Finish::matte},
        {"Woodfill", Finish::matte},
        {"PLA+WOOD Rosewood", Finish::matte},
        {"White Marble", Finish::matte},
        {"Bambu PLA Glow Green", Finish::matte},
        {"Prusament PC Blend Carbon Fiber", Finish::matte},
        {"CarbonX ASA Carbon Fibre Black", Finish::matte},
        {"Bambu PLA-CF", Finish::matte},
        {"PA6-GF20", Finish::matte},
        {"Shiny PETG", Finish::glossy},
        {"Carbon Black PLA", Finish::plain},
        {"Generic PLA", Finish::plain},
        {"MatthiasPrinter", Finish::plain},
        {"Rosewood", Finish::plain},
        {"Generic PLA @Silk Road Printer", Finish::plain},
        {"", Finish::plain},
        {"+", Finish::plain},
    };
    for (const auto& [name, finish] : names) EXPECT_EQ(finishOfProfile(name), finish) << name;
}

TEST(FinishWords, OfTheTable) {
    const auto finishOf = [](const char* name, const char* material, const char* stated) {
        return parseFilaments("\nA\t" + std::string(material) + "\t" + name + "\t112233\t" + stated + "\t\t\n", "t")
            .at(0)
            .finish;
    };
    EXPECT_EQ(finishOf("Galaxy Black", "PLA", ""), Finish::glitter);
    EXPECT_EQ(finishOf("Galaxy Black", "PLA", "glossy"), Finish::glitter);
    EXPECT_EQ(finishOf("Silk+ Gold", "PLA", "glossy"), Finish::silk);
    EXPECT_EQ(finishOf("Wood", "PLA", "glossy"), Finish::glossy);  // as its maker says
    EXPECT_EQ(finishOf("Black", "PETG-CF", ""), Finish::matte);
    EXPECT_EQ(finishOf("Black", "PETG", ""), Finish::plain);
    EXPECT_TRUE(colorNamed("Prusament PLA Galaxy Black", "").brdf.starts_with("glitter:"));
}

}  // namespace
}  // namespace stratum::shade
