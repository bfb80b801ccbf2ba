#include "gcode/thumbnail/container_thumbnails.h"

#include "base/checksum.h"
#include "base/error.h"
#include "gcode/container/bgcode.h"
#include "gcode/container/gx.h"
#include "gcode/container/little_endian.h"
#include "gcode/container/zip_archive.h"
#include "gcode/thumbnail/text_thumbnails.h"
#include "gcode/thumbnail/thumbnail.h"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stratum::gcode {
namespace {

constexpr std::size_t kHeader = 10;

std::string blockOf(const Thumbnail& thumbnail, bool checksum) {
    std::string block;
    appendLittleEndian(block, static_cast<std::uint32_t>(BlockType::thumbnail), 2);
    appendLittleEndian(block, static_cast<std::uint32_t>(BlockCompression::none), 2);
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.bytes.size()), 4);
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.size.coding), 2);  // 0 PNG, 1 JPG, 2 QOI
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.size.width), 2);
    appendLittleEndian(block, static_cast<std::uint32_t>(thumbnail.size.height), 2);
    block += thumbnail.bytes;
    if (checksum) appendLittleEndian(block, checksumOf(block), 4);
    return block;
}

}  // namespace

PatchedBytes withBgcodeThumbnails(std::string_view bytes, std::span<const Thumbnail> thumbnails,
                                  std::string_view name) {
    struct Place {
        std::size_t offset;
        BlockType type;
    };
    std::vector<Place> blocks;
    BlockReader reader(bytes, name);
    for (Block block; reader.next(block);) blocks.push_back({block.offset, block.type});
    blocks.push_back({bytes.size(), BlockType{0xffff}});

    std::optional<std::size_t> first;  // the thumbnail that is there
    std::size_t behind = kHeader;      // the metadata that stands before thumbnails
    for (std::size_t n = 0; n + 1 < blocks.size(); ++n) {
        if (blocks[n].type == BlockType::thumbnail && !first) first = blocks[n].offset;
        if (blocks[n].type == BlockType::file_metadata || blocks[n].type == BlockType::printer_metadata)
            behind = blocks[n + 1].offset;
    }
    const std::size_t place = first.value_or(behind);
    const bool checksums = littleEndian(bytes, 8, 2) != 0;

    PatchedBytes result;
    const auto insert = [&] {
        for (const Thumbnail& thumbnail : thumbnails) result.add(blockOf(thumbnail, checksums));
    };
    result.keep(bytes.substr(0, kHeader));
    for (std::size_t n = 0; n + 1 < blocks.size(); ++n) {
        if (blocks[n].offset == place) insert();
        if (blocks[n].type != BlockType::thumbnail)
            result.keep(bytes.substr(blocks[n].offset, blocks[n + 1].offset - blocks[n].offset));
    }
    if (place == bytes.size()) insert();
    return result;
}

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

namespace {

constexpr std::size_t kMostPicture = std::size_t{1} << 26;

std::optional<zip_uint64_t> find(zip_t* archive, std::string_view wanted) {
    const zip_int64_t entries = zip_get_num_entries(archive, 0);
    for (zip_int64_t i = 0; i < entries; ++i) {
        const char* raw = zip_get_name(archive, static_cast<zip_uint64_t>(i), ZIP_FL_ENC_RAW);
        if (raw == nullptr) continue;
        std::string_view entry = raw;
        if (entry.starts_with('/')) entry.remove_prefix(1);
        if (entry == wanted) return static_cast<zip_uint64_t>(i);
    }
    return std::nullopt;
}

std::string md5Of(const PatchedBytes& bytes) {
    const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned size = 0;
    if (!context || EVP_DigestInit_ex(context.get(), EVP_md5(), nullptr) != 1) throw std::bad_alloc();
    for (const std::string_view piece : bytes.pieces()) EVP_DigestUpdate(context.get(), piece.data(), piece.size());
    EVP_DigestFinal_ex(context.get(), digest.data(), &size);
    std::string text;
    for (unsigned i = 0; i < size; ++i) text += fmt::format("{:02X}", digest[i]);
    return text;
}

struct FreeSource {
    void operator()(zip_source_t* source) const { zip_source_free(source); }
};
using Source = std::unique_ptr<zip_source_t, FreeSource>;

/// An archive in memory, some of whose entries get new contents.
class ZipEdit {
public:
    ZipEdit(std::string_view bytes, std::string_view name) : name_(name) {
        // Written into it, so that it owns the copy: libzip 1.7 frees what the new container keeps of the old one, even
        // if it is not its own.
        source_.reset(zip_source_buffer_create(nullptr, 0, 0, nullptr));
        if (!source_) throw std::bad_alloc();
        if (zip_source_begin_write(source_.get()) != 0 ||
            zip_source_write(source_.get(), bytes.data(), bytes.size()) != static_cast<zip_int64_t>(bytes.size()) ||
            zip_source_commit_write(source_.get()) != 0)
            throw std::bad_alloc();
        zip_source_keep(source_.get());  // the archive owns the other reference
        archive_.reset(zip_open_from_source(source_.get(), 0, nullptr));
        if (!archive_) {
            zip_source_free(source_.get());
            fail("can't be opened for writing");
        }
    }

    void replace(zip_uint64_t index, std::string contents, bool stored) {
        zip_stat_t status;
        zip_stat_init(&status);
        zip_stat_index(archive_.get(), index, 0, &status);
        // What stays the same is not written again: versions of libzip give such entries other flags.
        if (holds(index, status, contents)) return;
        const std::string& kept = contents_.emplace_back(std::move(contents));
        zip_source_t* source = zip_source_buffer(archive_.get(), kept.data(), kept.size(), 0);
        if (source == nullptr) throw std::bad_alloc();
        if (zip_file_replace(archive_.get(), index, source, 0) != 0) {
            zip_source_free(source);
            fail(zip_strerror(archive_.get()));
        }
        zip_set_file_compression(archive_.get(), index, stored ? ZIP_CM_STORE : ZIP_CM_DEFLATE, 0);
        // Not the time of this run: the same input gives the same bytes.
        if ((status.valid & ZIP_STAT_MTIME) != 0) zip_file_set_mtime(archive_.get(), index, status.mtime, 0);
    }

    std::string finish() {
        if (zip_close(archive_.get()) != 0) fail(zip_strerror(archive_.get()));
        static_cast<void>(archive_.release());
        zip_stat_t status;
        zip_stat_init(&status);
        if (zip_source_stat(source_.get(), &status) != 0 || zip_source_open(source_.get()) != 0)
            fail("the new container can't be read");
        std::string packed(status.size, '\0');
        const zip_int64_t got = zip_source_read(source_.get(), packed.data(), packed.size());
        zip_source_close(source_.get());
        if (got != static_cast<zip_int64_t>(packed.size())) fail("the new container can't be read");
        return packed;
    }

private:
    bool holds(zip_uint64_t index, const zip_stat_t& status, const std::string& contents) const {
        if ((status.valid & ZIP_STAT_SIZE) == 0 || status.size != contents.size()) return false;
        const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> file(zip_fopen_index(archive_.get(), index, 0),
                                                                      &zip_fclose);
        std::string held(contents.size(), '\0');
        return file != nullptr &&
               zip_fread(file.get(), held.data(), held.size()) == static_cast<zip_int64_t>(held.size()) &&
               held == contents;
    }
    [[noreturn]] void fail(std::string_view why) const {
        throw InputError(fmt::format("{}: its pictures can't be replaced ({}); export it again", name_, why));
    }

    std::string_view name_;
    std::deque<std::string> contents_;  // the archive's sources point to them
    Source source_;
    ZipArchive archive_;
};

}  // namespace

/// The entries of one program that have to do with its pictures.
struct ZipThumbnails::Entries {
    zip_uint64_t text = 0;
    zip_uint64_t picture = 0;
    std::optional<zip_uint64_t> small, md5;
    std::optional<ThumbnailSize> small_size;
    ByteBuffer program;  // its text
    bool in_text = false;
};

ZipThumbnails::~ZipThumbnails() = default;
ZipThumbnails::ZipThumbnails(ZipThumbnails&&) noexcept = default;
ZipThumbnails& ZipThumbnails::operator=(ZipThumbnails&&) noexcept = default;

ZipThumbnails::ZipThumbnails(std::string_view bytes, std::string_view name, std::optional<int> plate)
    : bytes_(bytes), name_(name) {
    const ZipArchive holder = openZipArchive(bytes, name);
    zip_t* archive = holder.get();
    const ZipContents contents = listZip(archive, name);
    auto made = std::make_unique<Entries>();
    Entries& entries = *made;
    std::string picture;
    if (!contents.plates.empty()) {
        const ZipPlate& chosen = chooseZipPlate(contents.plates, name, plate);
        entries.text = chosen.index;
        picture = fmt::format("Metadata/plate_{}.png", chosen.number);
        entries.small = find(archive, fmt::format("Metadata/plate_{}_small.png", chosen.number));
        entries.md5 = find(archive, fmt::format("Metadata/plate_{}.gcode.md5", chosen.number));
    } else if (contents.ufp_model) {
        entries.text = *contents.ufp_model;
        picture = "Metadata/thumbnail.png";
    } else {
        throw InputError(fmt::format("{}: is a zip container without G-code; slice the model first", name));
    }
    const auto found = find(archive, picture);
    if (!found)
        throw InputError(
            fmt::format("{}: has no {} to replace; export it again with pictures, or unzip its G-code and give that",
                        name, picture));
    entries.picture = *found;
    if (entries.small) {
        ByteBuffer small;
        unpackZipEntry(archive, *entries.small, name, kMostPicture, small, {});
        entries.small_size = pngSize(small.view());
        if (!entries.small_size) entries.small.reset();  // of another kind: nothing is known to read it
    }
    unpackZipEntry(archive, entries.text, name, ContainerLimits{}.bytesFrom(bytes.size()), entries.program, {});
    entries.in_text = hasThumbnailPlace(entries.program.view(), name);
    entries_ = std::move(made);
}

std::vector<ThumbnailSize> ZipThumbnails::pictures(std::span<const ThumbnailSize> asked) const {
    std::vector<ThumbnailSize> pngs;
    std::copy_if(asked.begin(), asked.end(), std::back_inserter(pngs),
                 [](const ThumbnailSize& size) { return size.coding == ThumbnailCoding::png; });
    if (pngs.empty())
        throw UsageError(fmt::format("--thumbnail: the picture of {} is a PNG; ask for one, e.g. 512x512", name_));
    std::stable_sort(pngs.begin(), pngs.end(), [](const ThumbnailSize& a, const ThumbnailSize& b) {
        return a.width * a.height > b.width * b.height;
    });
    std::vector<ThumbnailSize> pictures{pngs.front()};
    if (entries_->small) pictures.push_back(pngs.size() > 1 ? pngs.back() : *entries_->small_size);
    if (entries_->in_text) pictures.insert(pictures.end(), asked.begin(), asked.end());
    return pictures;
}

PatchedBytes ZipThumbnails::patched(std::span<const ThumbnailSize> asked, std::span<const Thumbnail> pictures) const {
    ZipEdit edit(bytes_, name_);
    edit.replace(entries_->picture, pictures[0].bytes, true);
    if (entries_->small) edit.replace(*entries_->small, pictures[1].bytes, true);
    if (entries_->in_text) {
        const PatchedBytes text = withTextThumbnails(entries_->program.view(), pictures.last(asked.size()), name_);
        edit.replace(entries_->text, text.text(), false);
        if (entries_->md5) edit.replace(*entries_->md5, md5Of(text), false);
    }
    PatchedBytes result;
    result.add(edit.finish());
    return result;
}

}  // namespace stratum::gcode
