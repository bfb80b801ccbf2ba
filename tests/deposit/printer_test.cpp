#include "deposit/printer.h"

#include "base/error.h"
#include "base/input_file.h"
#include "corpus.h"
#include "deposit/read_print.h"
#include "refusal.h"
#include "scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

namespace stratum::deposit {
namespace {

double cornerOf(const std::string& text, double height = 0.2) {
    gcode::DepositModel deposit;
    deposit.corner_mm = 3;  // of an option before this one
    parseSection(text, deposit);
    return deposit.cornerRadius(height);
}

TEST(Printer, ReadsSections) {
    EXPECT_EQ(cornerOf("stadium"), 0.1);
    EXPECT_EQ(cornerOf("100%"), 0.1);
    EXPECT_EQ(cornerOf("50%"), 0.05);
    EXPECT_EQ(cornerOf("0.03"), 0.03);
    EXPECT_EQ(cornerOf("0"), 0);
    EXPECT_EQ(cornerOf("7"), 0.1);
}

TEST(Printer, RefusesOtherSections) {
    for (const char* text : {"", "%", "-1", "-5%", "101%", "1e300", "nan", "inf", "0.05mm", "round", "50%%", "5 %"}) {
        EXPECT_TRUE(test::refuses<UsageError>("corner radius in mm", [&] { cornerOf(text); }))
            << "'" << text << "' was taken";
    }
}

std::string write(const std::filesystem::path& folder, const std::string& text) {
    const auto path = folder / "printer.json";
    std::ofstream(path) << text;
    return path.string();
}

TEST(Printer, WhatHasNoEffectIsToldOf) {
    const InputFile file(test::dataDir() / "gcode" / "tile.gcode");
    gcode::ReadOptions options;
    const auto told = [&] {
        std::size_t count = 0;
        for (const gcode::Warning& warning : readPrint(file.bytes(), "tile.gcode", options, false).toolpath.warnings)
            count += warning.text.find("left out") != std::string::npos ? 1 : 0;
        return count;
    };
    EXPECT_EQ(told(), 0U);
    options.deposit.crown = 0.2;
    EXPECT_EQ(told(), 1U);
    options.deposit.pressure_advance = 0.05;
    EXPECT_EQ(told(), 2U);
    options.deposit.beads = gcode::DepositModel::Beads::settled;
    EXPECT_EQ(told(), 1U);
    options.deposit.flow_lag = 0.05;
    EXPECT_EQ(told(), 0U);
}

TEST(Printer, IdealIsTheDefaultAndTypicalIsNot) {
    gcode::ReadOptions options;
    usePrinter("typical", options);
    EXPECT_TRUE(options.deposit.settles());
    EXPECT_GT(options.deposit.flow_lag.value_or(0), 0);
    EXPECT_GT(options.deposit.sag, 0);
    usePrinter("ideal", options);
    EXPECT_EQ(gcode::describe(options.deposit), gcode::describe(gcode::DepositModel{}));
    EXPECT_FALSE(options.printer);
}

TEST(Printer, ReadsAFile) {
    const test::ScratchFolder folder;
    gcode::ReadOptions options;
    usePrinter(write(folder.path(), R"({"beads": "settled", "section": "60%", "flow_lag_s": 0.03,
        "pressure_advance_s": 0.02, "nozzle_diameter_mm": 0.6, "sag": 0.05,
        "strings": true, "limits": {"jerk_mm_s": [5, 6, 0.3, 2], "printing_mm_s2": 800}})"),
               options);
    EXPECT_TRUE(options.deposit.settles());
    EXPECT_EQ(options.deposit.corner_fraction, 0.6);
    EXPECT_EQ(options.deposit.flow_lag, 0.03);
    EXPECT_EQ(options.deposit.pressure_advance, 0.02);
    EXPECT_EQ(options.deposit.nozzle_diameter, 0.6);
    EXPECT_EQ(options.deposit.sag, 0.05);
    EXPECT_TRUE(options.deposit.strings);
    ASSERT_TRUE(options.printer);
    EXPECT_EQ(options.printer->limits.jerk[1], 6);
    EXPECT_EQ(options.printer->limits.printing, 800);
    EXPECT_EQ(options.printer->limits.travel, gcode::MachineLimits().travel);
}

TEST(Printer, RefusesWhatNoPrinterIs) {
    const test::ScratchFolder folder;
    const std::pair<const char*, const char*> kFiles[] = {
        {"{\"sagg\": 0.1}", "sagg: unknown key; did you mean 'sag'?"},
        {"{\"sag\": 7}", "sag: expected a number from 0 to 0.5"},
        {"{\"sag\": \"much\"}", "sag: expected a number"},
        {"{\"flow_lag_s\": -1}", "flow_lag_s: expected a number from 0 to 10"},
        {"{\"flow_lag_s\": 1e999}", "printer.json"},
        {"{\"section\": \"round\"}", "section: expected"},
        {"{\"section\": 0.5}", "section: expected"},
        {"{\"beads\": \"wet\"}", "beads: expected capsule or settled"},
        {"{\"limits\": {\"jerk_mm_s\": [1, 2]}}", "limits.jerk_mm_s: expected 4 numbers"},
        {"{\"limits\": {\"printing_mm_s2\": 0}}", "limits.printing_mm_s2: expected"},
        {"{\"limits\": {\"speed\": 1}}", "limits.speed: unknown key"},
        {"{\"limits\": {\"travel_mm_s2\": 1, \"max_accel_mm_s2\": 2}}",
         "limits.travel_mm_s2: expected each limit once"},
        {"[1]", "expected an object"},
        {"{", "no JSON"},
        {"", "is empty"},
    };
    for (const auto& [text, message] : kFiles) {
        gcode::ReadOptions options;
        try {
            usePrinter(write(folder.path(), text), options);
            ADD_FAILURE() << text << " was taken";
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << text << ": " << error.what();
        }
    }
    gcode::ReadOptions options;
    EXPECT_THROW(usePrinter("tipical", options), UsageError);
}

}  // namespace
}  // namespace stratum::deposit
