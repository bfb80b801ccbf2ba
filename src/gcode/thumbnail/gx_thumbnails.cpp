#include "gcode/thumbnail/gx_thumbnails.h"

#include "base/error.h"
#include "gcode/container/gx.h"
#include "gcode/container/little_endian.h"
#include "gcode/thumbnail/png_size.h"

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace stratum::gcode {
namespace {

constexpr ThumbnailSize kBitmap{80, 60, ThumbnailCoding::bmp};

struct Layout {
    std::size_t bitmap = 0, png = 0, text = 0;  // offsets; bitmap <= png <= text
    bool hasPng() const { return png < text; }
};

// Where the pictures are; nothing if they aren't where the head says.
std::optional<Layout> layoutOf(std::string_view bytes) {
    const Layout layout{littleEndian(bytes, gx::kBitmapAt, 4), littleEndian(bytes, gx::kPngAt, 4),
                        littleEndian(bytes, gx::kTextAt, 4)};
    const bool ordered =
        layout.bitmap >= gx::kHeaderBytes && layout.bitmap + 6 <= layout.png && layout.png <= layout.text;
    if (!ordered || bytes.substr(layout.bitmap, 2) != "BM") return std::nullopt;
    if (layout.hasPng() && !pngSize(bytes.substr(layout.png, layout.text - layout.png))) return std::nullopt;
    return layout;
}

}  // namespace

std::vector<ThumbnailSize> gxPictures(std::string_view bytes, std::span<const ThumbnailSize> asked,
                                      std::string_view name) {
    const std::optional<Layout> layout = layoutOf(bytes);
    if (!layout)
        throw InputError(
            fmt::format("{}: this .gx has no BMP picture to replace; export it again with FlashPrint, or save its text "
                        "as .gcode",
                        name));
    std::vector<ThumbnailSize> pictures{kBitmap};
    if (layout->hasPng()) pictures.push_back(*pngSize(bytes.substr(layout->png, layout->text - layout->png)));
    bool png_given = false;
    for (const ThumbnailSize& size : asked) {
        if (size.width == kBitmap.width && size.height == kBitmap.height) continue;
        if (!layout->hasPng() || png_given || size.coding != ThumbnailCoding::png)
            throw UsageError(fmt::format(
                "--thumbnail {}x{}/{}: {} is a .gx, whose picture has 80x60 pixels{}; give "
                "--thumbnail 80x60{}",
                size.width, size.height, codingName(size.coding), name,
                layout->hasPng() ? ", with one PNG beside it" : "",
                layout->hasPng() ? fmt::format(" or 80x60,{}x{}", pictures.back().width, pictures.back().height) : ""));
        pictures.back() = size;
        png_given = true;
    }
    return pictures;
}

PatchedBytes withGxThumbnails(std::string_view bytes, std::span<const Thumbnail> pictures) {
    const Layout layout = layoutOf(bytes).value();
    const std::size_t png = layout.bitmap + pictures[0].bytes.size();
    const std::size_t text = png + (pictures.size() > 1 ? pictures[1].bytes.size() : 0);
    std::string head;
    appendLittleEndian(head, static_cast<std::uint32_t>(png), 4);
    appendLittleEndian(head, static_cast<std::uint32_t>(text), 4);
    PatchedBytes result;
    result.keep(bytes.substr(0, gx::kPngAt));
    result.add(head);
    result.keep(bytes.substr(gx::kTextAt + 4, layout.bitmap - gx::kTextAt - 4));
    for (const Thumbnail& picture : pictures) result.add(picture.bytes);
    result.keep(bytes.substr(layout.text));
    return result;
}

}  // namespace stratum::gcode
