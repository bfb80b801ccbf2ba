#include "shade/palette/color_name.h"
#include "shade/finish/named_brdf.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <string>

namespace stratum::shade {
namespace {

std::string messageOf(const std::string& text) {
    try {
        (void)colorNamed(text, "--color");
    } catch (const UsageError& error) {
        return error.what();
    }
    ADD_FAILURE() << text << " is taken";
    return {};
}

bool holds(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(ColorName, NumbersAndCssStandBeforeFilaments) {
    EXPECT_EQ(colorNamed("#Ff8000", "").color, 0xff8000U);
    EXPECT_EQ(colorNamed("#f80", "").color, 0xff8800U);
    EXPECT_EQ(colorNamed("Teal", "").color, 0x008080U);
    EXPECT_EQ(colorNamed("black", "").color, 0U);
    EXPECT_EQ(colorNamed("teal", "").brdf, "teal");
}

TEST(ColorName, FindsAFilamentByItsWords) {
    for (const char* text : {"Prusament Galaxy Black", "galaxy black prusament", "PRUSAMENT  galaxy-BLACK",
                             "prusament petg galaxy black"}) {
        const ColorName found = colorNamed(text, "--color");
        EXPECT_EQ(found.color, 0x3d3e3dU) << text;
        EXPECT_TRUE(holds(found.name, "Prusament")) << found.name;
    }
    // One word too few in the name is no matter, if only one is meant.
    EXPECT_EQ(colorNamed("Polymaker Galaxy Teal", "").color, 0x2dccd3U);
}

TEST(ColorName, SeveralThatDifferAreNamedWithTheirMakers) {
    const std::string message = messageOf("Galaxy Black");
    EXPECT_TRUE(holds(message, "--color Galaxy Black")) << message;
    EXPECT_TRUE(holds(message, "did you mean 'Devil Design PETG Galaxy Black' (#333333)")) << message;
    EXPECT_TRUE(holds(message, "'Prusament PETG Galaxy Black' (#3d3e3d)")) << message;
}

TEST(ColorName, GuessesAtSlips) {
    const std::string message = messageOf("Prusamnt Galxy Blak");
    EXPECT_TRUE(holds(message, "did you mean 'Prusament PETG Galaxy Black'") ||
                holds(message, "did you mean 'Prusament PLA Galaxy Black'"))
        << message;
    EXPECT_TRUE(holds(messageOf("#12345"), "is no colour"));
    EXPECT_TRUE(holds(messageOf(""), "is no colour"));
    EXPECT_TRUE(holds(messageOf("\xff\xff"), "is no colour"));
    EXPECT_LT(messageOf(std::string(100000, 'x')).size(), 400U);
}

TEST(ColorName, TheFinishIsAMaterial) {
    EXPECT_EQ(brdfOf(0xff8000, Finish::plain), "#ff8000");
    for (const Finish finish : {Finish::matte, Finish::glossy, Finish::silk, Finish::glitter})
        EXPECT_NO_THROW((void)makeBrdf(brdfOf(0xff8000, finish)));
    const ColorName sparkling = colorNamed("Bambu Lab Purple Galaxy", "");
    EXPECT_TRUE(sparkling.brdf.starts_with("glitter:")) << sparkling.brdf;
    EXPECT_TRUE(colorNamed("3DJAKE Silk Gold", "").brdf.starts_with("silk:"));
}

TEST(ColorName, Lists) {
    EXPECT_EQ(filamentsWith("prusament galaxy").size(), 5U);
    const std::string list = listFilaments("bambu purple galaxy");
    EXPECT_EQ(list.find("Bambu Lab PLA Purple Galaxy"), 0U);
    EXPECT_TRUE(holds(list, "#594177  glitter\n")) << list;
    EXPECT_EQ(listFilaments("no such thing"), "");
}

}  // namespace
}  // namespace stratum::shade
