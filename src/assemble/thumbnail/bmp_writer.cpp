#include "assemble/thumbnail/bmp_and_qoi.h"

#include <cstddef>
#include <stdexcept>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace stratum::assemble {

std::string encodeBmp(int width, int height, const std::vector<std::uint8_t>& rgb) {
    if (width < 1 || height < 1 || rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw std::invalid_argument("these bytes are no RGB picture of that size");
    std::string bytes;
    const auto append = [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
    };
    stbi_write_bmp_to_func(append, &bytes, width, height, 3, rgb.data());
    return bytes;
}

}  // namespace stratum::assemble
