// The planned seconds beside those of two firmwares' own planners: every file of the corpus's tables.
#include "corpus.h"
#include "gcode/container/container.h"
#include "motion/print_times.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::motion {
namespace {

using gcode::CornerRule;
using gcode::MachineLimits;

// A row of a table: file, machine or rule, third column, seconds.
struct Row {
    std::string file;
    std::string machine;
    double third = 0;
    double seconds = 0;
};

std::vector<Row> rowsOf(const std::filesystem::path& path) {
    std::ifstream in(path);
    std::string line;
    std::getline(in, line);  // heads
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        std::istringstream words(line);
        Row row;
        words >> row.file >> row.machine >> row.third >> row.seconds;
        rows.push_back(row);
    }
    return rows;
}

std::filesystem::path pathOf(const std::string& file) {
    for (const char* folder : {"times", "gcode"})
        for (const char* end : {"", ".gcode"}) {
            const std::filesystem::path path = test::corpusDir() / folder / (file + end);
            if (std::filesystem::exists(path)) return path;
        }
    return {};
}

// The program without the lines that were taken out for the firmware; their numbers stay.
std::string programOf(const std::filesystem::path& path, const std::vector<std::string_view>& left_out) {
    const gcode::InputBytes file(path.string());
    const gcode::Program program = gcode::openContainer(file.bytes(), file.name());
    std::string text;
    std::string_view rest = program.text;
    while (!rest.empty()) {
        const auto end = std::min(rest.find('\n'), rest.size());
        const std::string_view line = rest.substr(0, end);
        if (std::none_of(left_out.begin(), left_out.end(), [&](auto begin) { return line.starts_with(begin); }))
            text += line;
        text += '\n';
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return text;
}

double secondsOf(const std::string& program, const MachineLimits& limits, gcode::Firmware firmware) {
    gcode::PrinterLimits printer;
    printer.limits = limits;
    printer.firmware = firmware;
    for (std::size_t n = 0; n < gcode::kLimitCount; ++n)
        printer.origins[static_cast<gcode::Limit>(n)].kind = gcode::LimitOrigin::Kind::printer;
    gcode::ReadOptions options;
    options.printer = printer;
    PrintTimes times;
    readTimedToolpath(program, "test.gcode", options, times);
    return times.total;
}

// Prints the table; every row is within `each` of the firmware's time, half of them within `median` (shares).
void compare(const std::filesystem::path& table, const std::vector<std::string_view>& left_out, double each,
             double median, gcode::Firmware firmware, const std::function<MachineLimits(const Row&)>& machine) {
    std::vector<double> shares;
    for (const Row& row : rowsOf(table)) {
        const std::filesystem::path path = pathOf(row.file);
        ASSERT_FALSE(path.empty()) << row.file;
        const double seconds = secondsOf(programOf(path, left_out), machine(row), firmware);
        const double share = seconds / row.seconds - 1;
        fmt::print("| {} | {} | {} | {} | {:.3f} | {:+.4f} % |\n", row.file, row.machine, row.third, row.seconds,
                   seconds, 100 * share);
        EXPECT_LE(std::abs(share), each) << row.file << " " << row.machine << " " << row.third;
        shares.push_back(std::abs(share));
    }
    ASSERT_GT(shares.size(), 30U);
    std::nth_element(shares.begin(), shares.begin() + static_cast<std::ptrdiff_t>(shares.size() / 2), shares.end());
    EXPECT_LE(shares[shares.size() / 2], median);
}

// As printer.cfg has them (README.md of the tables).
MachineLimits klipperMachine(const Row& row) {
    struct Machine {
        double speed, acceleration, corner, z_speed, z_acceleration;
    };
    const bool b = row.machine.starts_with('B');
    const Machine m = b                    ? Machine{500, 10000, 8, 20, 500}
                      : row.machine == "O" ? Machine{600, 20000, 9, 20, 500}
                      : row.machine == "S" ? Machine{200, 1000, 5, 10, 50}
                                           : Machine{300, 3000, 5, 15, 100};
    // Klipper's default for moves of E alone: four squares of the nozzle's diameter over the section of the filament.
    const double ratio = 4 * 0.4 * 0.4 / (std::numbers::pi * 0.875 * 0.875);
    MachineLimits limits;
    limits.rule = CornerRule::corner_velocity;
    limits.speed.fill(MachineLimits::kNone);
    limits.acceleration.fill(MachineLimits::kNone);
    limits.speed[2] = m.z_speed;
    limits.acceleration[2] = m.z_acceleration;
    limits.path_speed = m.speed;
    limits.printing = limits.travel = m.acceleration;
    limits.corner_velocity = m.corner;
    limits.extrude_only_speed = b ? 100 : row.machine == "O" ? 30 : ratio * m.speed;
    limits.retracting = b || row.machine == "O" ? 5000 : ratio * m.acceleration;
    if (row.machine == "Bres") limits.arc_resolution = 0.1;
    return limits;
}

MachineLimits marlinMachine(const Row& row) {
    MachineLimits limits;
    if (row.machine == "junction_deviation") {
        limits.rule = CornerRule::junction_deviation;
        limits.acceleration = {3000, 3000, 100, 5000};
        limits.speed = {300, 300, 15, 60};
        limits.printing = limits.retracting = 1500;
        limits.travel = 2000;
        limits.junction_deviation = 0.02;
    } else {
        limits.rule = CornerRule::marlin_jerk;
        limits.acceleration = {9000, 9000, 500, 10000};
        limits.speed = {500, 500, 12, 120};
        limits.printing = limits.retracting = limits.travel = 1500;
        limits.jerk = {10, 10, 0.4, 5};
    }
    const double fine = row.third / 80;
    limits.steps_per_mm = {80 * fine, 80 * fine, 400 * fine, 93 * fine};
    return limits;
}

TEST(FirmwareTimes, AreKlippers) {
    STRATUM_NEEDS_CORPUS(table, "times/klipper.tsv");
    compare(table, {"; machine_max_", "M201 ", "M203 ", "M205 "}, 0.0005, 0.00005, gcode::Firmware::klipper,
            klipperMachine);
}

TEST(FirmwareTimes, AreMarlins) {
    STRATUM_NEEDS_CORPUS(table, "times/marlin.tsv");
    compare(table, {"; machine_max_", "M201 ", "M203 ", "M205 ", "M900 ", "M572 ", "M220 ", "SET_"}, 0.003, 0.001,
            gcode::Firmware::marlin, marlinMachine);
}

}  // namespace
}  // namespace stratum::motion
