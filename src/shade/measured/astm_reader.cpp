#include "shade/measured/text_readers.h"

#include "shade/measured/scan_text.h"
#include "shade/primaries.h"

#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostReadings = std::size_t{1} << 23;
constexpr double kMostAngle = 3600;  // degrees
constexpr double kSame = 1e-5;       // radians: angles closer than this are one

struct Channels {
    std::size_t count = 0;
    ChannelChoice choice{0, 0, 0};
    bool xyz = false;
};

Channels readNames(ScanText& text, std::string_view list) {
    std::vector<std::string> names;
    while (!list.empty()) {
        const std::size_t end = list.find_first_of(", \t");
        if (end != 0) names.emplace_back(list.substr(0, end));
        list.remove_prefix(end == std::string_view::npos ? list.size() : end + 1);
    }
    if (names.size() < 5) text.fail("VARS must name theta_i, phi_i, theta_s, phi_s and at least one channel");
    Channels channels;
    channels.count = names.size() - 4;
    std::vector<double> wavelengths;
    for (std::size_t n = 4; n < names.size(); ++n) {
        double value = 0.0;
        fast_float::from_chars(names[n].data(), names[n].data() + names[n].size(), value);
        wavelengths.push_back(value);
    }
    if (channels.count == 3 && wavelengths[0] == 0.0) {
        channels.choice = {0, 1, 2};
        channels.xyz = names[4] == "X" && names[5] == "Y" && names[6] == "Z";
    } else {
        channels.choice = chooseChannels(wavelengths);
    }
    return channels;
}

/// The index of an angle in a list; angles that differ by rounding are the same.
long keyOf(double angle) { return std::lround(angle / kSame); }

}  // namespace

bool isAstm(std::string_view text) {
    const std::string_view head = text.substr(0, 65536);
    return head.find("VARS") != std::string_view::npos && head.find("theta_i") != std::string_view::npos;
}

BrdfScan readAstm(std::string_view bytes, std::string_view name) {
    ScanText text(bytes, name);
    Channels channels;
    std::string_view line;
    while (channels.count == 0) {
        line = text.expect("VARS");
        const Keyword k = splitKeyword(line);
        if (k.key == "VARS") channels = readNames(text, k.value);
    }
    std::vector<std::vector<double>> rows;
    bool degrees = false;
    while (text.next(line)) {
        rows.push_back(text.parse(line, "a reading"));
        if (rows.back().size() != 4 + channels.count)
            text.fail(fmt::format("{} numbers; VARS names {}", rows.back().size(), 4 + channels.count));
        if (rows.size() > kMostReadings) text.fail(fmt::format("more than {} readings", kMostReadings));
        for (std::size_t n = 0; n < 4; ++n)
            if (!(std::abs(rows.back()[n]) <= kMostAngle))
                text.fail(fmt::format("{:g} is no angle in radians or degrees", rows.back()[n]));
        for (std::size_t n = 0; n < 4; ++n)
            degrees = degrees || std::abs(rows.back()[n]) > 2.0 * std::numbers::pi + 1e-3;
    }
    if (rows.empty()) text.fail("no readings");

    const double unit = degrees ? std::numbers::pi / 180.0 : 1.0;
    std::map<std::tuple<long, long, long>, Color> readings;
    std::map<long, Color> at_pole;  // by incidence: there one reading serves all azimuths
    std::map<long, double> incidences, azimuths, polars;
    const long turn = keyOf(2.0 * std::numbers::pi);
    for (const std::vector<double>& row : rows) {
        double azimuth = (row[3] - row[1]) * unit;
        azimuth -= 2.0 * std::numbers::pi * std::floor(azimuth / (2.0 * std::numbers::pi) + 1e-9);
        azimuth = std::max(azimuth, 0.0);
        if (keyOf(azimuth) >= turn) azimuth = 0.0;
        const double incidence = row[0] * unit;
        const double polar = row[2] * unit;
        if (polar > 0.5 * std::numbers::pi + kSame) continue;  // transmission
        const auto value = [&](std::size_t c) { return row[4 + c]; };
        const ChannelChoice& ch = channels.choice;
        const Color color(channels.xyz ? fromXyz(value(0), value(1), value(2))
                                       : glm::dvec3(value(ch.red), value(ch.green), value(ch.blue)));
        incidences.emplace(keyOf(incidence), incidence);
        azimuths.emplace(keyOf(azimuth), azimuth);
        polars.emplace(keyOf(polar), std::min(polar, 0.5 * std::numbers::pi));
        readings.insert_or_assign({keyOf(incidence), keyOf(azimuth), keyOf(polar)}, color);
        if (keyOf(polar) == 0) at_pole.emplace(keyOf(incidence), color);
    }
    BrdfScan scan;
    for (const std::string& comment : text.comments()) scan.notes.push_back(comment);
    for (const auto& i : incidences) scan.incidences.push_back(i.second);
    for (const auto& a : azimuths) scan.azimuths.push_back(a.second);
    for (const auto& p : polars) scan.polars.push_back(p.second);
    // Readings at the pole alone would make a grid of the square of their number.
    scan.checkAngles(name);
    for (const auto& i : incidences) {
        for (const auto& a : azimuths) {
            for (const auto& p : polars) {
                const auto found = readings.find({i.first, a.first, p.first});
                const auto pole = p.first == 0 ? at_pole.find(i.first) : at_pole.end();
                if (found != readings.end() || pole != at_pole.end()) {
                    scan.values.push_back(found != readings.end() ? found->second : pole->second);
                    continue;
                }
                text.fail(
                    fmt::format("no reading at theta_i {:g}, phi_s - phi_i {:g}, theta_s {:g} degrees; they must form "
                                "a grid",
                                i.second * 180.0 / std::numbers::pi, a.second * 180.0 / std::numbers::pi,
                                p.second * 180.0 / std::numbers::pi));
            }
        }
    }
    scan.check(name);
    return turnScan(scan, findMirrorAzimuth(scan));
}

}  // namespace stratum::shade
