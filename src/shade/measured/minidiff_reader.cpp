#include "shade/measured/text_readers.h"

#include "shade/angles.h"
#include "shade/measured/scan_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostAngles = 2000;
constexpr std::size_t kMostBlocks = 4096;
constexpr std::size_t kMostValues = std::size_t{1} << 26;

struct Block {
    double aoi = 0.0, wavelength = 0.0;
    std::optional<double> tis;
    std::vector<double> readings;
    std::size_t line = 0;
};

struct MiniDiffFile {
    std::vector<double> azimuths, radials;  // degrees
    std::vector<Block> blocks;
    std::size_t skipped = 0;
};

MiniDiffFile readBlocks(ScanText& text) {
    MiniDiffFile file;
    Block block;
    bool front = true;
    bool brdf = true;
    std::string_view line;
    const auto number = [&](std::string_view value, std::string_view what) {
        const std::vector<double> v = text.parse(value, what);
        if (v.size() != 1) text.fail(fmt::format("expected {}, one number", what));
        return v[0];
    };
    // The matrix follows the last keyword of a block; it shows by its first character.
    std::size_t readings = 0;
    while (text.next(line)) {
        const Keyword k = splitKeyword(line);
        if (k.key == "DataEnd") return file;
        if (k.key == "ScatterAzimuth") {
            file.azimuths = text.numbers(countOf(text, k.value, "the number of azimuths", 1, kMostAngles), "azimuths");
        } else if (k.key == "ScatterRadial") {
            file.radials =
                text.numbers(countOf(text, k.value, "the number of radial angles", 2, kMostAngles), "radial angles");
        } else if (k.key == "AOI") {
            block.aoi = number(k.value, "the angle of incidence in degrees");
        } else if (k.key == "Wavelength") {
            block.wavelength = number(k.value, "the wavelength in nm");
        } else if (k.key == "TIS") {
            block.tis = number(k.value, "the total integrated scatter");
        } else if (k.key == "Side") {
            front = k.value == "Front";
        } else if (k.key == "ScatterType") {
            brdf = k.value == "BRDF";
        } else if (line[0] == '-' || line[0] == '+' || line[0] == '.' || (line[0] >= '0' && line[0] <= '9')) {
            if (file.azimuths.empty() || file.radials.empty())
                text.fail("readings before ScatterAzimuth and ScatterRadial; their meaning is unknown");
            block.line = text.line();
            block.readings = text.parse(line, "a reading");
            const std::size_t count = file.azimuths.size() * file.radials.size();
            readings += count;
            if (file.blocks.size() >= kMostBlocks || readings > kMostValues)
                text.fail(fmt::format("more than {} blocks or {} readings; this is no scan of a surface", kMostBlocks,
                                      kMostValues));
            if (block.readings.size() > count)
                text.fail(fmt::format("{} readings; expected {}", block.readings.size(), count));
            const std::string what =
                fmt::format("reading of block {} (AOI {:g}, {:g} nm), {} x {}", file.blocks.size() + 1, block.aoi,
                            block.wavelength, file.azimuths.size(), file.radials.size());
            if (block.readings.size() < count) {
                const std::vector<double> rest = text.numbers(count - block.readings.size(), what);
                block.readings.insert(block.readings.end(), rest.begin(), rest.end());
            }
            if (front && brdf)
                file.blocks.push_back(block);
            else
                ++file.skipped;
            block.tis.reset();
        }
    }
    return file;
}

}  // namespace

bool isMiniDiff(std::string_view text) {
    const std::string_view head = text.substr(0, 65536);
    return head.find("ScatterRadial") != std::string_view::npos &&
           head.find("AngleOfIncidence") == std::string_view::npos;
}

BrdfScan readMiniDiff(std::string_view bytes, std::string_view name) {
    ScanText text(bytes, name);
    const MiniDiffFile file = readBlocks(text);
    if (file.blocks.empty())
        text.fail(fmt::format("no block of a front side's BRDF was found ({} others were skipped)", file.skipped));

    std::vector<double> wavelengths;
    std::map<double, std::map<double, const Block*>> by_angle;
    for (const Block& block : file.blocks) {
        if (!by_angle[block.aoi].emplace(block.wavelength, &block).second)
            text.fail(fmt::format("AOI {:g} at {:g} nm comes twice", block.aoi, block.wavelength));
        if (std::find(wavelengths.begin(), wavelengths.end(), block.wavelength) == wavelengths.end())
            wavelengths.push_back(block.wavelength);
    }
    const ChannelChoice choice = chooseChannels(wavelengths);
    BrdfScan scan;
    for (const std::string& comment : text.comments()) scan.notes.push_back(comment);
    for (const double a : file.azimuths) scan.azimuths.push_back(a * kRadians);
    for (const double r : file.radials) scan.polars.push_back(r * kRadians);
    for (const auto& [aoi, blocks] : by_angle) {
        if (blocks.size() != wavelengths.size())
            text.fail(fmt::format("AOI {:g} has {} wavelengths, others {}", aoi, blocks.size(), wavelengths.size()));
        scan.incidences.push_back(aoi * kRadians);
        const std::vector<double>& r = blocks.at(wavelengths[choice.red])->readings;
        const std::vector<double>& g = blocks.at(wavelengths[choice.green])->readings;
        const std::vector<double>& b = blocks.at(wavelengths[choice.blue])->readings;
        scan.append(r, g, b, name, [](double x, double y, double z) { return Color(glm::dvec3(x, y, z)); });
    }
    scan.check(name);
    if (file.skipped > 0)
        scan.notes.push_back(fmt::format("{} blocks of other sides or kinds were skipped", file.skipped));

    const double mirror = findMirrorAzimuth(scan);
    scan.notes.push_back(fmt::format("mirror direction at azimuth {:g} degrees", mirror / kRadians));
    scan = turnScan(scan, mirror);
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        const Color whole = scanAlbedo(scan, i);
        const auto& blocks = by_angle.at(std::next(by_angle.begin(), static_cast<std::ptrdiff_t>(i))->first);
        const std::optional<double> tis = blocks.at(wavelengths[choice.red])->tis;
        if (tis && std::abs(*tis - static_cast<double>(whole.r)) > 0.05 * std::abs(*tis) + 0.002)
            scan.notes.push_back(fmt::format("AOI {:g}: the readings integrate to {:.4f}, the file's TIS says {:.4f}",
                                             scan.incidences[i] / kRadians, whole.r, *tis));
    }
    return scan;
}

}  // namespace stratum::shade
