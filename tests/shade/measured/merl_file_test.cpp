#include "shade/measured/merl_file.h"

#include "base/error.h"
#include "base/input_file.h"
#include "scratch_folder.h"

#include <cmath>
#include <cstring>

namespace stratum {
namespace {

using shade::Color;
using shade::HalfDiffTable;

TEST(MerlFile, GoesRound) {
    const test::ScratchFolder scratch;
    std::vector<Color> values(HalfDiffTable::kCells);
    for (std::size_t n = 0; n < values.size(); ++n)
        values[n] = Color(float(n % 97) * 0.01f, float(n % 31) * 0.1f, float(n % 7));
    shade::writeMerl(scratch / "t.binary", HalfDiffTable(values));
    const InputFile file(scratch / "t.binary");
    EXPECT_EQ(file.bytes().size(), 12u + 3u * 8u * 90u * 90u * 180u);
    ASSERT_TRUE(shade::isMerl(file.bytes()));
    const auto back = shade::readMerl(file.bytes(), "t");
    for (std::size_t n = 0; n < values.size(); ++n)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(back.values()[n][c], values[n][c], 1e-6f * values[n][c]);
}

TEST(MerlFile, FillsHolesAndRefusesDamage) {
    const test::ScratchFolder scratch;
    std::vector<Color> values(HalfDiffTable::kCells, Color(0.5f));
    shade::writeMerl(scratch / "t.binary", HalfDiffTable(values));
    std::string bytes(InputFile(scratch / "t.binary").bytes());
    constexpr std::size_t kShell = 90 * 180;
    const auto set = [&](std::size_t cell, double value) {
        std::memcpy(bytes.data() + 12 + cell * sizeof(double), &value, sizeof(value));
    };
    set(3 * kShell + 5, -1.0);
    set(7, -1.0);  // no smaller half angle to take it from
    const auto table = shade::readMerl(bytes, "t");
    EXPECT_EQ(table.values()[3 * kShell + 5], Color(0.5f));
    EXPECT_EQ(table.values()[7], Color(0.0f));
    set(99, std::nan(""));
    EXPECT_THROW(shade::readMerl(bytes, "t"), InputError);
    EXPECT_THROW(shade::readMerl(std::string_view(bytes).substr(0, bytes.size() - 8), "t"), InputError);
    EXPECT_THROW(shade::readMerl("abc", "t"), InputError);
}

}  // namespace
}  // namespace stratum
