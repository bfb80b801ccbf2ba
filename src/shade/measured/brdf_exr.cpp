#include "shade/measured/brdf_exr.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/own_file.h"
#include "shade/angles.h"
#include "shade/measured/scan_text.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostTexels = std::size_t{1} << 26;

struct Layout {
    int columns = 1, rows = 1;
};

struct Words {
    const ExrImage& image;
    const std::string& name;

    std::optional<std::string> find(std::initializer_list<const char*> keys) const {
        for (const char* key : keys)
            if (const auto found = image.attributes.find(key); found != image.attributes.end()) return found->second;
        return std::nullopt;
    }
    [[noreturn]] void fail(const std::string& message) const { throw InputError(fmt::format("{}: {}", name, message)); }
};

/// The discontinuity of the picture at the inner seams of a layout, relative to other positions.
double seamContrast(const ExrImage& image, Layout layout) {
    const int tile_w = image.width / layout.columns;
    const int tile_h = image.height / layout.rows;
    double at_seams = 0.0, elsewhere = 1e-6;
    std::size_t seams = 0, others = 0;
    const auto value = [&](int x, int y) {
        const Color& c =
            image
                .rgb[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)];
        return std::log(std::max(static_cast<double>(luminance(c)), 1e-7));
    };
    const auto add = [&](double jump, bool seam) {
        (seam ? at_seams : elsewhere) += jump;
        ++(seam ? seams : others);
    };
    for (int y = 0; y < image.height; ++y)
        for (int x = 1; x < image.width; ++x) add(std::abs(value(x, y) - value(x - 1, y)), x % tile_w == 0);
    for (int y = 1; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) add(std::abs(value(x, y) - value(x, y - 1)), y % tile_h == 0);
    return seams == 0 ? 0.0 : at_seams / static_cast<double>(seams) / (elsewhere / static_cast<double>(others));
}

Layout layoutOf(const Words& words, std::size_t tiles, std::vector<std::string>& notes) {
    const ExrImage& image = words.image;
    const auto fits = [&](Layout l) {
        return l.columns > 0 && l.rows > 0 && image.width % l.columns == 0 && image.height % l.rows == 0 &&
               image.width / l.columns > 1 && image.height / l.rows > 1;
    };
    std::optional<Layout> told;
    if (const auto text = words.find({"layout", "Layout"})) {
        Layout l;
        if (std::sscanf(text->c_str(), "%dx%d", &l.columns, &l.rows) != 2)
            words.fail(fmt::format("layout '{}' is not of the form COLUMNSxROWS, e.g. 4x1", text->substr(0, 40)));
        told = l;
    } else if (const auto columns = words.find({"columns", "tilesX", "tiles_x"})) {
        const auto rows = words.find({"rows", "tilesY", "tiles_y"});
        told = Layout{std::atoi(columns->c_str()), rows ? std::atoi(rows->c_str()) : 1};
    }
    if (told) {
        if (!fits(*told) || static_cast<std::size_t>(told->columns) * static_cast<std::size_t>(told->rows) != tiles)
            words.fail(fmt::format("a layout of {} x {} tiles does not fit {} angles in {} x {} texels", told->columns,
                                   told->rows, tiles, image.width, image.height));
        return *told;
    }
    Layout best;
    double contrast = -1.0;
    const int n = static_cast<int>(tiles);
    for (const Layout l : {Layout{n, 1}, Layout{1, n}, Layout{2, n / 2}}) {
        if (!fits(l) || l.columns * l.rows != n) continue;
        const double c = seamContrast(image, l);
        if (c > contrast) {
            contrast = c;
            best = l;
        }
    }
    if (contrast < 0.0)
        words.fail(fmt::format("{} x {} texels can't hold {} tiles; give the attribute layout, e.g. 4x1", image.width,
                               image.height, tiles));
    notes.push_back(fmt::format("layout {}x{} found by its seams", best.columns, best.rows));
    return best;
}

std::vector<double> axis(int count, double last, bool nodes) {
    std::vector<double> angles;
    angles.reserve(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) angles.push_back(last * (nodes ? i / (count - 1.0) : (i + 0.5) / count));
    return angles;
}

/// Whether all tiles are brightest at their top: then angles are the half vector's.
bool highlightAtTop(const BrdfScan& scan) {
    int oblique = 0, top = 0;
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        if (scan.incidences[i] < 15.0 * kRadians) continue;
        double brightest = -1.0, where = 0.0;
        for (std::size_t p = 0; p < scan.polars.size(); ++p) {
            if (scan.polars[p] > 75.0 * kRadians) continue;  // all tables are bright at grazing angles
            for (std::size_t a = 0; a < scan.azimuths.size(); ++a) {
                const double v = static_cast<double>(luminance(scan.values[scan.index(i, a, p)]));
                if (v <= brightest) continue;
                brightest = v;
                where = scan.polars[p];
            }
        }
        ++oblique;
        top += where < 0.35 * scan.incidences[i];
    }
    return oblique > 0 && top == oblique;
}

/// From angles of the half vector to angles of the detector.
BrdfScan fromHalf(const BrdfScan& half) {
    BrdfScan scan{half.incidences,
                  evenAngles(0.0, std::numbers::pi, 73),
                  evenAngles(0.0, 0.5 * std::numbers::pi, 91),
                  {},
                  half.notes};
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        const glm::dvec3 light(std::sin(scan.incidences[i]), 0.0, std::cos(scan.incidences[i]));
        for (const double a : scan.azimuths) {
            for (const double p : scan.polars) {
                const glm::dvec3 d(std::sin(p) * std::cos(a), std::sin(p) * std::sin(a), std::cos(p));
                const glm::dvec3 h = glm::normalize(light + d);
                scan.values.emplace_back(scanAt(half, i, std::atan2(h.y, h.x), std::atan2(std::hypot(h.x, h.y), h.z)));
            }
        }
    }
    return scan;
}

}  // namespace

BrdfScan readBrdfExr(const std::filesystem::path& path) {
    const std::string name = path.string();
    const ExrImage image = readExr(path, kMostTexels);
    const Words words{image, name};
    BrdfScan scan;
    for (const char* key : {"comment", "status", "source"})
        if (const auto text = words.find({key})) scan.notes.push_back(*text);

    std::vector<double> degrees = {0.0, 20.0, 40.0, 60.0};
    if (const auto text = words.find({"thetaI", "theta_i", "incidences"}))
        degrees = ScanText({}, name + ": thetaI").parse(*text, "an angle in degrees");
    if (degrees.empty() || degrees.size() > 180) words.fail("thetaI must list from 1 to 180 angles");
    for (const double d : degrees) scan.incidences.push_back(d * kRadians);

    const Layout layout = layoutOf(words, degrees.size(), scan.notes);
    const int tile_w = image.width / layout.columns;
    const int tile_h = image.height / layout.rows;
    const auto sampling = words.find({"sampling"});
    const auto nodes = [&](int count) { return sampling ? *sampling == "nodes" : count % 2 == 1; };
    scan.azimuths = axis(tile_w, 2.0 * std::numbers::pi, nodes(tile_w));
    scan.polars = axis(tile_h, 0.5 * std::numbers::pi, nodes(tile_h));
    for (int tile = 0; tile < layout.columns * layout.rows; ++tile) {
        const int x0 = tile % layout.columns * tile_w;
        const int y0 = tile / layout.columns * tile_h;
        for (int x = 0; x < tile_w; ++x)
            for (int y = 0; y < tile_h; ++y)
                scan.values.push_back(
                    image.rgb[static_cast<std::size_t>(y0 + y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x0 + x)]);
    }
    scan.check(name);
    const auto meaning = words.find({"meaning"});
    if (meaning && *meaning != "half" && *meaning != "detector")
        words.fail(fmt::format("meaning '{}' is neither detector nor half", meaning->substr(0, 40)));
    if (meaning ? *meaning == "half" : highlightAtTop(scan)) {
        scan.notes.emplace_back("angles are those of the half vector");
        return fromHalf(scan);
    }
    return turnScan(scan, findMirrorAzimuth(scan));
}

void writeBrdfExr(const std::filesystem::path& path, const BrdfScan& scan) {
    // Azimuths across the whole turn, even steps, both ends included.
    constexpr int kWidth = 73;
    const int tile_h = 91;
    const auto tiles = scan.incidences.size();
    const int height = tile_h * static_cast<int>(tiles);
    std::vector<Color> texels;
    std::vector<double> degrees;
    for (std::size_t i = 0; i < tiles; ++i) {
        degrees.push_back(std::round(scan.incidences[i] / kRadians * 1e6) * 1e-6);
        for (int y = 0; y < tile_h; ++y)
            for (int x = 0; x < kWidth; ++x)
                texels.emplace_back(scanAt(scan, i, 2.0 * std::numbers::pi * x / (kWidth - 1),
                                           0.5 * std::numbers::pi * y / (tile_h - 1)));
    }
    Imf::Header header(kWidth, height, 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y, Imf::ZIP_COMPRESSION);
    header.insert("layout", Imf::StringAttribute(fmt::format("1x{}", tiles)));
    header.insert("thetaI", Imf::StringAttribute(fmt::format("{}", fmt::join(degrees, ","))));
    header.insert("sampling", Imf::StringAttribute("nodes"));
    header.insert("meaning", Imf::StringAttribute("detector"));
    header.insert("software", Imf::StringAttribute(kProgramMark));
    header.insert("comment", Imf::StringAttribute(fmt::format("{}", fmt::join(scan.notes, "; "))));
    Imf::FrameBuffer buffer;
    constexpr std::array<const char*, 3> kNames = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        header.channels().insert(kNames[static_cast<std::size_t>(c)], Imf::Channel(Imf::FLOAT));
        buffer.insert(kNames[static_cast<std::size_t>(c)],
                      Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&texels[0][c]), sizeof(Color),
                                 sizeof(Color) * static_cast<std::size_t>(kWidth)));
    }
    AtomicFile(path).write([&](const std::filesystem::path& to) {
        try {
            Imf::OutputFile out(to.c_str(), header, 0);
            out.setFrameBuffer(buffer);
            out.writePixels(height);
        } catch (const std::exception& error) {
            throw writeError(path.string(), error.what());
        }
    });
}

}  // namespace stratum::shade
