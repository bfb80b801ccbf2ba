#include "assemble/thumbnail/bmp_and_qoi.h"

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <stdexcept>

#define QOI_IMPLEMENTATION
#include <qoi.h>

namespace stratum::assemble {

std::string encodeQoi(int width, int height, const std::vector<std::uint8_t>& rgba) {
    if (width < 1 || height < 1 ||
        rgba.size() != 4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw std::invalid_argument("these bytes are no RGBA picture of that size");
    const qoi_desc description{static_cast<unsigned>(width), static_cast<unsigned>(height), 4, QOI_SRGB};
    int length = 0;
    const std::unique_ptr<void, decltype(&std::free)> bytes(qoi_encode(rgba.data(), &description, &length), &std::free);
    if (!bytes) throw std::bad_alloc();
    return {static_cast<const char*>(bytes.get()), static_cast<std::size_t>(length)};
}

}  // namespace stratum::assemble
