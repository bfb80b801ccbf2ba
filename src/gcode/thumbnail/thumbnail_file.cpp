#include "gcode/thumbnail/thumbnail_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "gcode/container/bgcode.h"
#include "gcode/container/container.h"
#include "gcode/container/gx.h"
#include "gcode/container/gzip.h"
#include "gcode/container/zip_archive.h"
#include "gcode/thumbnail/container_thumbnails.h"
#include "gcode/thumbnail/text_thumbnails.h"

#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

// An open deflate stream that makes gzip.
class Gzip {
public:
    Gzip() {
        constexpr int kGzip = 15 + 16;  // the largest window, with gzip's head
        constexpr int kMemory = 8;      // zlib's default
        if (deflateInit2(&stream_, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, kMemory, Z_DEFAULT_STRATEGY) != Z_OK)
            throw std::bad_alloc();
    }
    ~Gzip() { deflateEnd(&stream_); }
    Gzip(const Gzip&) = delete;
    Gzip& operator=(const Gzip&) = delete;

    void add(std::string_view bytes, bool last) {
        constexpr std::size_t kMost = std::numeric_limits<uInt>::max();
        do {
            const std::string_view part = bytes.substr(0, kMost);
            bytes.remove_prefix(part.size());
            stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(part.data()));
            stream_.avail_in = static_cast<uInt>(part.size());
            run(last && bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
        } while (!bytes.empty());
    }
    std::string take() { return std::move(packed_); }

private:
    void run(int flush) {
        constexpr std::size_t kRoom = std::size_t{1} << 20;
        do {
            const std::size_t before = packed_.size();
            packed_.resize(before + kRoom);
            stream_.next_out = reinterpret_cast<Bytef*>(packed_.data() + before);
            stream_.avail_out = kRoom;
            deflate(&stream_, flush);
            packed_.resize(before + kRoom - stream_.avail_out);
        } while (stream_.avail_out == 0);
    }

    z_stream stream_{};
    std::string packed_;
};

PatchedBytes gzipped(const PatchedBytes& text) {
    Gzip gzip;
    for (const std::string_view piece : text.pieces()) gzip.add(piece, false);
    gzip.add({}, true);
    PatchedBytes result;
    result.add(gzip.take());
    return result;
}

}  // namespace

ThumbnailFile::ThumbnailFile(std::string_view bytes, std::string_view name, std::vector<ThumbnailSize> asked,
                             std::optional<int> plate)
    : bytes_(bytes), name_(name), asked_(std::move(asked)) {
    if (isZip(bytes_)) zip_.emplace(bytes_, name_, plate);
}

std::vector<ThumbnailSize> ThumbnailFile::pictures() const {
    if (zip_) return zip_->pictures(asked_);
    if (isGx(bytes_)) return gxPictures(bytes_, asked_, name_);
    return asked_;
}

std::vector<ThumbnailSize> ThumbnailFile::leftOut() const {
    const std::vector<ThumbnailSize> held = pictures();
    std::vector<ThumbnailSize> left;
    for (const ThumbnailSize& size : asked_)
        if (std::none_of(held.begin(), held.end(), [&size](const ThumbnailSize& other) {
                // The BMP of a .gx stands for any kind of its size.
                return other == size || (other.coding == ThumbnailCoding::bmp && other.width == size.width &&
                                         other.height == size.height);
            }))
            left.push_back(size);
    return left;
}

PatchedBytes ThumbnailFile::patched(std::span<const Thumbnail> pictures) const {
    if (zip_) return zip_->patched(asked_, pictures);
    if (isGx(bytes_)) return withGxThumbnails(bytes_, pictures);
    if (isBgcode(bytes_)) return withBgcodeThumbnails(bytes_, pictures, name_);
    if (!isGzip(bytes_)) return withTextThumbnails(bytes_, pictures, name_);
    const Program program = openContainer(bytes_, name_);
    return gzipped(withTextThumbnails(program.text, pictures, name_));
}

void writePatched(const PatchedBytes& bytes, const std::filesystem::path& path) {
    AtomicFile(path).write([&](const std::filesystem::path& to) {
        errno = 0;
        std::ofstream out(to, std::ios::binary);
        for (const std::string_view piece : bytes.pieces())
            out.write(piece.data(), static_cast<std::streamsize>(piece.size()));
        out.close();
        if (!out) throw writeError(to.string(), errno != 0 ? std::strerror(errno) : "unknown error");
    });
}

}  // namespace stratum::gcode
