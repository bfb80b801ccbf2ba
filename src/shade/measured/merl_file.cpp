#include "shade/measured/merl_file.h"

#include "base/atomic_file.h"
#include "base/error.h"

#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace stratum::shade {
namespace {

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr std::array<std::int32_t, 3> kSizes = {HalfDiffTable::kHalf, HalfDiffTable::kDiff, HalfDiffTable::kTurn};
constexpr std::array<double, 3> kScale = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
constexpr std::size_t kBytes = sizeof(kSizes) + 3 * HalfDiffTable::kCells * sizeof(double);

}  // namespace

bool isMerl(std::string_view bytes) {
    return bytes.size() >= sizeof(kSizes) && std::memcmp(bytes.data(), kSizes.data(), sizeof(kSizes)) == 0;
}

HalfDiffTable readMerl(std::string_view bytes, std::string_view name) {
    if (!isMerl(bytes)) throw InputError(fmt::format("{}: is no MERL table of 90 x 90 x 180 cells", name));
    if (bytes.size() != kBytes)
        throw InputError(fmt::format("{}: has {} bytes; a MERL table has {}. Copy or download it again", name,
                                     bytes.size(), kBytes));
    std::vector<Color> values(HalfDiffTable::kCells);
    constexpr std::size_t kShell = std::size_t{HalfDiffTable::kDiff} * HalfDiffTable::kTurn;
    for (std::size_t n = 0; n < HalfDiffTable::kCells; ++n) {
        bool measured = true;
        for (std::size_t c = 0; c < 3; ++c) {
            double v = 0.0;
            std::memcpy(&v, bytes.data() + sizeof(kSizes) + (c * HalfDiffTable::kCells + n) * sizeof(double),
                        sizeof(v));
            if (!std::isfinite(v) || v > 1e12)
                throw InputError(fmt::format("{}: cell {} of channel {} is {}; the file is damaged", name, n, c, v));
            measured = measured && v >= 0.0;
            values[n][static_cast<int>(c)] = static_cast<float>(v * kScale[c]);
        }
        if (!measured) values[n] = n >= kShell ? values[n - kShell] : Color(0.0f);
    }
    return HalfDiffTable(std::move(values));
}

void writeMerl(const std::filesystem::path& path, const HalfDiffTable& table) {
    FileWriter out(path);
    out.raw(kSizes);
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t n = 0; n < HalfDiffTable::kCells; ++n)
            out.raw(static_cast<double>(table.values()[n][static_cast<int>(c)]) / kScale[c]);
    out.commit();
}

}  // namespace stratum::shade
