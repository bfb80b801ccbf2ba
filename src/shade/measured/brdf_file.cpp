#include "shade/measured/brdf_file.h"

#include "base/error.h"
#include "base/input_file.h"
#include "shade/angles.h"
#include "shade/measured/brdf_exr.h"
#include "shade/measured/merl_file.h"
#include "shade/measured/scan_interpolant.h"
#include "shade/measured/text_readers.h"

#include <fmt/format.h>
#include <zlib.h>
#include <glm/geometric.hpp>

#include <numbers>

namespace stratum::shade {
namespace {

constexpr std::size_t kMostText = std::size_t{1} << 28;  // a scan of every degree everywhere is not larger

/// Unpacks a gzip file through zlib's own reader, which checks its CRC.
std::string gunzip(const std::filesystem::path& path) {
    struct Closer {
        void operator()(gzFile_s* file) const { gzclose(file); }
    };
    const std::unique_ptr<gzFile_s, Closer> file(gzopen(path.c_str(), "rb"));
    if (!file) throw InputError(fmt::format("{}: can't be opened", path.string()));
    std::string text;
    std::vector<char> chunk(std::size_t{1} << 18);
    for (;;) {
        const int count = gzread(file.get(), chunk.data(), static_cast<unsigned>(chunk.size()));
        int status = Z_OK;
        if (count < 0)
            throw InputError(fmt::format("{}: the compressed data is damaged ({}); copy or download it again",
                                         path.string(), gzerror(file.get(), &status)));
        text.append(chunk.data(), static_cast<std::size_t>(count));
        if (text.size() > kMostText)
            throw InputError(
                fmt::format("{}: unpacks to more than {} bytes; this is no BRDF", path.string(), kMostText));
        if (count == 0) break;
    }
    int status = Z_OK;
    gzerror(file.get(), &status);
    if (status == Z_BUF_ERROR)
        throw InputError(fmt::format("{}: ends in the middle of its compressed data; copy it again", path.string()));
    return text;
}

/// A table sampled like a scatterometer scan, to fit the lobes for importance sampling.
BrdfScan scanOfTable(const HalfDiffTable& table, std::vector<double> incidences) {
    return makeScan([&table](const glm::dvec3& light,
                             const glm::dvec3& detector) { return table.at(glm::vec3(detector), glm::vec3(light)); },
                    std::move(incidences), evenAngles(0.0, std::numbers::pi, 37), evenAngles(0.0, 89.0 * kRadians, 90));
}

std::shared_ptr<const TableBrdf> fromScan(const BrdfScan& raw, const std::string& kind) {
    const BrdfScan scan = foldScan(raw);
    const ScanInterpolant whole(scan);
    std::vector<std::string> notes = scan.notes;
    std::string angles;
    for (const double i : scan.incidences) angles += fmt::format("{}{:g}", angles.empty() ? "" : ", ", i / kRadians);
    notes.push_back(fmt::format("{}: incidences {} degrees, {} x {} angles of detection", kind, angles,
                                scan.azimuths.size(), scan.polars.size()));
    return std::make_shared<TableBrdf>(
        HalfDiffTable::bake([&whole](const glm::dvec3& wo, const glm::dvec3& wi) { return whole.eval(wi, wo); }),
        whole.lobes(), std::move(notes));
}

}  // namespace

MeasuredMaterial readMeasuredMaterial(const std::filesystem::path& path) {
    const InputFile file(path);
    const std::string name = path.string();
    std::string_view bytes = file.bytes();
    if (isExr(bytes)) return {"EXR texture", readBrdfExr(path)};
    std::string unpacked;
    if (bytes.starts_with("\x1f\x8b")) {
        unpacked = gunzip(path);
        bytes = unpacked;
    }
    if (isMerl(bytes)) return {"MERL table", readMerl(bytes, name)};
    if (bytes.size() > kMostText)
        throw InputError(fmt::format("{}: has {} bytes; no BRDF has more than {}", name, bytes.size(), kMostText));
    if (isZemax(bytes)) return {"Zemax", readZemax(bytes, name)};
    if (isMiniDiff(bytes)) return {"Mini-Diff", readMiniDiff(bytes, name)};
    if (isAstm(bytes)) return {"ASTM E1392", readAstm(bytes, name)};
    throw InputError(
        fmt::format("{}: is no BRDF that can be read; expected Mini-Diff (LightTools), Zemax or ASTM E1392 "
                    "text, a MERL .binary or an EXR texture",
                    name));
}

std::shared_ptr<const TableBrdf> readBrdfFile(const std::filesystem::path& path) {
    MeasuredMaterial measured = readMeasuredMaterial(path);
    if (const auto* scan = std::get_if<BrdfScan>(&measured.data)) return fromScan(*scan, measured.kind);
    auto& table = std::get<HalfDiffTable>(measured.data);
    const auto lobes = fitLobes(scanOfTable(table, {0.0, 20 * kRadians, 40 * kRadians, 60 * kRadians, 75 * kRadians}));
    return std::make_shared<TableBrdf>(std::move(table), lobes, std::vector<std::string>{measured.kind});
}

void writeBrdfFile(const std::filesystem::path& path, const Brdf& brdf) {
    const std::string ending = path.extension().string();
    const auto value = [&brdf](const glm::dvec3& a, const glm::dvec3& b) {
        // The nearest pair above the horizon: tables have cells that straddle it.
        const auto lifted = [](glm::dvec3 d) {
            d.z = std::max(d.z, 1e-4);
            return glm::vec3(glm::normalize(d));
        };
        return glm::dvec3(brdf.eval(lifted(b), lifted(a)));
    };
    if (ending == ".binary") {
        writeMerl(path, HalfDiffTable::bake(value));
    } else if (ending == ".exr") {
        BrdfScan scan = makeScan([&](const glm::dvec3& light, const glm::dvec3& d) { return Color(value(light, d)); },
                                 {0.0, 20 * kRadians, 40 * kRadians, 60 * kRadians},
                                 evenAngles(0.0, std::numbers::pi, 37), evenAngles(0.0, 0.5 * std::numbers::pi, 91));
        scan.notes = brdf.notes();
        writeBrdfExr(path, scan);
    } else {
        throw UsageError(fmt::format("{}: the name must end in .binary (MERL) or .exr (texture)", path.string()));
    }
}

}  // namespace stratum::shade
