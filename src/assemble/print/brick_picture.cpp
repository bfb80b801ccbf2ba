#include "assemble/print/brick_picture.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "march/brick/brick_projection.h"
#include "shade/film/png_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

namespace stratum::assemble {
namespace {

using Rgb = std::array<double, 3>;  // sRGB, 0 to 255
constexpr Rgb kPaper{255, 255, 255};
constexpr Rgb kNotAsked{196, 200, 206};
constexpr Rgb kFew{250, 190, 120};
constexpr Rgb kAll{160, 40, 0};

Rgb mixed(const Rgb& a, const Rgb& b, double t) {
    return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

// Shares of a few per cent are what there is to see: by their root.
Rgb colorOf(std::uint32_t listed, std::uint32_t made) {
    if (listed == 0) return kPaper;
    if (made == 0) return kNotAsked;
    return mixed(kFew, kAll, std::sqrt(static_cast<double>(made) / listed));
}

}  // namespace

void writeBrickPicture(const std::string& path, const march::BrickGrid& bricks, const shade::Metadata& metadata) {
    if (!path.ends_with(".png")) throw UsageError(fmt::format("--brick-picture {}: expected a .png", path));
    const march::BrickProjection views[2] = {march::projectBricks(bricks, 1), march::projectBricks(bricks, 2)};
    constexpr std::size_t kGap = 4;  // bricks
    const std::size_t columns = views[0].width + kGap + views[1].width;
    const std::size_t rows = std::max(views[0].height, views[1].height);
    // Small prints are shown large enough to see single bricks.
    constexpr std::size_t kWanted = 1000;
    const std::size_t scale = std::max<std::size_t>(1, kWanted / columns);
    std::vector<std::uint8_t> rgb(3 * columns * scale * rows * scale, 255);
    for (std::size_t v = 0; v < 2; ++v) {
        const march::BrickProjection& view = views[v];
        const std::size_t left = v == 0 ? 0 : views[0].width + kGap;
        const std::size_t top = rows - view.height;
        for (std::size_t n = 0; n < view.listed.size(); ++n) {
            const Rgb color = colorOf(view.listed[n], view.made[n]);
            for (std::size_t p = 0; p < scale * scale; ++p) {
                const std::size_t x = (left + n % view.width) * scale + p % scale;
                const std::size_t y = (top + n / view.width) * scale + p / scale;
                for (std::size_t c = 0; c < 3; ++c)
                    rgb[3 * (y * columns * scale + x) + c] = static_cast<std::uint8_t>(std::lround(color[c]));
            }
        }
    }
    AtomicFile(path).write([&](const std::filesystem::path& to) {
        shade::writePng(to, static_cast<int>(columns * scale), static_cast<int>(rows * scale), rgb, metadata);
    });
}

}  // namespace stratum::assemble
