#include "deposit/limits/limit_files.h"

#include "deposit/limits/printer_files.h"

#include <fmt/format.h>

namespace stratum::deposit {
namespace {

std::string valueIn(const KlipperConfig& config, const char* section, const char* option) {
    const KlipperConfig::Value* value = config.find(section, option);
    return value == nullptr ? "none" : value->text;
}

// What Python's RawConfigParser(strict=False, inline_comment_prefixes=(';', '#')) reads of the same lines, after
// Klipper has cut them at '#'.
TEST(KlipperConfig, HasTheGrammarOfPythonsParser) {
    const KlipperConfig config("p.cfg",
                               "; a comment\n[Printer]\nA:1\n[printer]\r\nMax_Velocity = 300 ; fast\nb:2;3\nc : 4#5\n"
                               "d=e=f:g\n  more\n\n   ; inside\n\teven more\n[printer] ; again\na: 5\n"
                               "[x]\na: 1\n  [y]\nb:\n    c: 6\n");
    EXPECT_EQ(valueIn(config, "Printer", "a"), "1");
    EXPECT_EQ(valueIn(config, "printer", "max_velocity"), "300");
    EXPECT_EQ(valueIn(config, "printer", "b"), "2;3");
    EXPECT_EQ(valueIn(config, "printer", "c"), "4");
    EXPECT_EQ(valueIn(config, "printer", "d"), "e=f:g\nmore\neven more");
    EXPECT_EQ(valueIn(config, "printer", "a"), "5");
    EXPECT_EQ(config.find("printer", "a")->place, "p.cfg:14");
    // An indented head goes on with the value before it.
    EXPECT_FALSE(config.has("y"));
    EXPECT_EQ(valueIn(config, "x", "a"), "1\n[y]");
    EXPECT_EQ(valueIn(config, "x", "b"), "\nc: 6");
    EXPECT_THROW(KlipperConfig("p.cfg", "a: 1\n[printer]\n"), InputError);
    EXPECT_THROW(KlipperConfig("p.cfg", "[printer]\nnothing\n"), InputError);
    EXPECT_THROW(KlipperConfig("p.cfg", "[printer]\n: 5\n"), InputError);
}

TEST(KlipperConfig, TheLastOfEqualOptionsCountsAlsoOverIncludes) {
    const PrinterFiles files;
    files.write("b.cfg", "[printer]\nmax_accel: 2\n");
    files.write("a.cfg", "[printer]\nmax_accel: 1\n[extruder]\nnozzle_diameter: 0.4\n");
    files.write(".hidden.cfg", "[printer]\nmax_accel: 9\n");
    const auto read = [&files](const char* text) { return KlipperConfig(files.write("printer.cfg", text), text); };
    const KlipperConfig config = read("[printer]\nmax_accel: 0\n[include [ab].cfg]\n[printer]\nmax_velocity: 3\n");
    EXPECT_EQ(valueIn(config, "printer", "max_accel"), "2");
    EXPECT_TRUE(config.find("printer", "max_accel")->place.ends_with("b.cfg:2"));
    EXPECT_EQ(valueIn(config, "printer", "max_velocity"), "3");
    EXPECT_EQ(valueIn(config, "extruder", "nozzle_diameter"), "0.4");
    EXPECT_EQ(valueIn(read("[include [!p]*.cfg] # all\n"), "printer", "max_accel"), "2");
    EXPECT_EQ(valueIn(read("[include none*.cfg]\n[printer]\na: 1\n"), "printer", "a"), "1");  // as in Klipper
}

TEST(KlipperConfig, SavedOptionsHoldWhereTheRestIsSilent) {
    const PrinterFiles files;
    const std::string saved =
        "\n#*# <---------------------- SAVE_CONFIG ---------------------->\n"
        "#*# DO NOT EDIT THIS BLOCK OR BELOW. The contents are auto-generated.\n#*#\n"
        "#*# [extruder]\n#*# pressure_advance = 0.05\n#*# nozzle_diameter = 0.6\n#*#\n#*# [printer]\n#*# max_accel = "
        "7\n";
    const std::string text = "[extruder]\nnozzle_diameter: 0.4\n[printer]\n" + saved;
    const KlipperConfig config("p.cfg", text);
    EXPECT_EQ(valueIn(config, "extruder", "pressure_advance"), "0.05");
    EXPECT_EQ(config.find("extruder", "pressure_advance")->place, "p.cfg:9");
    EXPECT_EQ(valueIn(config, "extruder", "nozzle_diameter"), "0.4");
    EXPECT_EQ(valueIn(config, "printer", "max_accel"), "7");
    // Somebody wrote into it: Klipper ignores all of it.
    EXPECT_EQ(valueIn(KlipperConfig("p.cfg", text + "max_accel: 5\n"), "printer", "max_accel"), "none");
    EXPECT_EQ(valueIn(KlipperConfig("p.cfg", text + "#*#x\n"), "printer", "max_accel"), "none");
}

TEST(KlipperConfig, RefusesIncludesThatDoNotEnd) {
    const PrinterFiles files;
    EXPECT_TRUE(says(files.refusal("[printer]\n[include missing.cfg]\n"), "printer:2: the included file"));
    EXPECT_TRUE(says(files.refusal("[include printer]\n"), "is included by itself"));
    files.write("one.cfg", "\n[include two.cfg]\n");
    files.write("two.cfg", "[include ./../*/one.cfg]\n");
    EXPECT_TRUE(says(files.refusal("[include one.cfg]\n"), "two.cfg:1"));
    // Ten files, each twice in the next: 1024 readings.
    files.write("n0.cfg", "[printer]\n");
    for (int n = 1; n <= 10; ++n)
        files.write(fmt::format("n{}.cfg", n), fmt::format("[include n{}.cfg]\n[include n{}.cfg]\n", n - 1, n - 1));
    EXPECT_TRUE(says(files.refusal("[include n10.cfg]\n"), "more than 1000 files"));
    for (int n = 1; n <= 200; ++n) files.write(fmt::format("d{}.cfg", n), fmt::format("[include d{}.cfg]\n", n + 1));
    EXPECT_TRUE(says(files.refusal("[include d1.cfg]\n"), "more than 100 includes in each other"));
}

TEST(KlipperConfig, IsToldByTheHeadOfASection) {
    EXPECT_TRUE(looksLikeKlipperConfig("# my printer\r\n[mcu]\r\nserial: /dev/x\r\n"));
    EXPECT_FALSE(looksLikeKlipperConfig("[12:30] echo: M92 X80\n; [printer]\n[\n[1]\n"));
}

}  // namespace
}  // namespace stratum::deposit
