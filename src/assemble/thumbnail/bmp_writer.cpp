#include "assemble/thumbnail/bmp_writer.h"

#include "gcode/container/little_endian.h"

#include <cstddef>
#include <stdexcept>

namespace stratum::assemble {

std::string encodeBmp(int width, int height, const std::vector<std::uint8_t>& rgb) {
    if (width < 1 || height < 1 || rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw std::invalid_argument("these bytes are no RGB picture of that size");
    constexpr std::uint32_t kHeads = 54;
    constexpr std::uint32_t kDotsPerMetre = 3780;  // 96 an inch
    const auto columns = static_cast<std::size_t>(width);
    const auto rows = static_cast<std::size_t>(height);
    const std::size_t stride = (3 * columns + 3) / 4 * 4;
    const auto pixels = static_cast<std::uint32_t>(stride * rows);
    std::string bytes = "BM";
    const auto put = [&bytes](std::uint32_t value, std::size_t count) {
        gcode::appendLittleEndian(bytes, value, count);
    };
    for (const std::uint32_t value : {kHeads + pixels, 0u, kHeads, 40u}) put(value, 4);
    put(static_cast<std::uint32_t>(width), 4);
    put(static_cast<std::uint32_t>(height), 4);
    put(1, 2);
    put(24, 2);
    for (const std::uint32_t value : {0u, pixels, kDotsPerMetre, kDotsPerMetre, 0u, 0u}) put(value, 4);
    for (std::size_t y = rows; y-- > 0;) {
        for (std::size_t x = 0; x < columns; ++x)
            for (std::size_t c = 3; c-- > 0;) bytes += static_cast<char>(rgb[3 * (y * columns + x) + c]);
        bytes.append(stride - 3 * columns, '\0');
    }
    return bytes;
}

}  // namespace stratum::assemble
