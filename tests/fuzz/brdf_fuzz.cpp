// libFuzzer: any bytes as a measured material, of whichever kind they look like. Only InputError may come out of
// reading them, and what is read must be a BRDF: finite and not negative.
//
// How to build and run it stands in scripts/fuzz.sh. MERL tables have 35 MB, always; the bytes behind their head are
// repeated up to that.
#include "base/error.h"
#include "fuzz/memory_file.h"
#include "fuzz/require.h"
#include "shade/measured/brdf_file.h"
#include "shade/measured/merl_file.h"
#include "shade/measured/scan_interpolant.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace {

using stratum::shade::Color;

void requireColor(const Color& c) { require(stratum::shade::isFinite(c) && c.r >= 0.0f && c.g >= 0.0f && c.b >= 0.0f); }

void check(const stratum::shade::BrdfScan& raw) {
    raw.check("fuzz");
    const stratum::shade::BrdfScan scan = stratum::shade::foldScan(raw);
    require(scan.values.size() == scan.incidences.size() * scan.azimuths.size() * scan.polars.size());
    for (const Color& value : scan.values) requireColor(value);
    constexpr std::size_t kFew = 24;  // a fit to more finds nothing, slowly
    if (scan.values.size() > kFew) return;
    const stratum::shade::ScanInterpolant whole(scan);
    for (const glm::dvec3& wo : {glm::dvec3(0.0, 0.0, 1.0), glm::dvec3(-0.6, 0.0, 0.8), glm::dvec3(0.0, 1.0, 0.0)}) {
        const glm::dvec3 value = whole.eval({0.8, 0.0, 0.6}, wo);
        for (int c = 0; c < 3; ++c) require(std::isfinite(value[c]) && value[c] >= 0.0);
    }
}

void check(const stratum::shade::HalfDiffTable& table) {
    requireColor(table.at({0.0f, 0.0f, 1.0f}, {0.6f, 0.0f, 0.8f}));
    requireColor(table.at({0.8f, 0.0f, 0.6f}, {0.6f, 0.0f, 0.8f}));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string bytes(reinterpret_cast<const char*>(data), size);
    constexpr std::size_t kHead = 12;
    constexpr std::size_t kMerl = kHead + 3 * stratum::shade::HalfDiffTable::kCells * sizeof(double);
    if (stratum::shade::isMerl(bytes) && size > kHead + 64) {
        bytes.reserve(kMerl);
        while (bytes.size() < kMerl) bytes.append(bytes, kHead, kMerl - bytes.size());
    }
    const stratum::test::MemoryFile file(bytes);
    try {
        std::visit([](const auto& measured) { check(measured); },
                   stratum::shade::readMeasuredMaterial(file.path()).data);
    } catch (const stratum::InputError&) {
    }
    return 0;
}
