#include "shade/parts/part_sums.h"

#include "base/error.h"

#include <ImfInputFile.h>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <exception>

namespace stratum::shade {
namespace {

// OpenEXR unpacks 16 rows at once. Some more, since each time all files are opened anew: there may be too many to keep
// them open.
constexpr int kRows = 32;

/// The shares of one picture, read from top to bottom.
class SumsReader {
public:
    explicit SumsReader(const PartFile& file) : file_(file), crc_(file.part.head), aovs_(aovsOf(file.part)) {}

    /// The sums of the next rows.
    PixelSums read(const PixelBox& rows) {
        const auto pixels = static_cast<std::size_t>(rows.width()) * static_cast<std::size_t>(rows.height());
        PixelSums sums(pixels, aovs_);
        sums.sums().growTo(file_.part.planes);
        try {
            Imf::InputFile file(file_.path.c_str(), 1);
            file.setFrameBuffer(exrBufferOf(sums, rows));
            file.readPixels(rows.y0, rows.y1 - 1);
        } catch (const std::exception& error) {
            throw InputError(
                fmt::format("{}: is damaged ({}); trace this shard again", file_.path.string(), error.what()));
        }
        crc_ = crcOf(crc_, sums, rows);
        return sums;
    }
    /// When all are read. Throws InputError.
    void check() const {
        if (crc_ != file_.part.crc)
            throw InputError(
                fmt::format("{}: is damaged (its checksum is wrong); trace this shard again", file_.path.string()));
    }

private:
    const PartFile& file_;
    std::uint32_t crc_;
    std::vector<Aov> aovs_;
};

std::vector<PixelBox> bandsOf(const PixelBox& region) {
    std::vector<PixelBox> bands;
    for (int y = region.y0; y < region.y1; y += kRows)
        bands.push_back({region.x0, y, region.x1, std::min(y + kRows, region.y1)});
    return bands;
}

}  // namespace

std::vector<std::string> channelsOfSums(std::size_t each, std::size_t planes) {
    std::vector<std::string> names;
    for (std::size_t plane = 0; plane < planes; ++plane)
        for (std::size_t n = 0; n < each; ++n)
            for (const char* half : {"low", "high"}) names.push_back(fmt::format("sum{:02}.{}.{}", n, plane, half));
    return names;
}

Imf::FrameBuffer exrBufferOf(const PixelSums& sums, const PixelBox& rows) {
    static_assert(std::endian::native == std::endian::little);  // the low half of a double comes first
    const Imath::Box2i place(Imath::V2i(rows.x0, rows.y0), Imath::V2i(rows.x1 - 1, rows.y1 - 1));
    const std::size_t pixel = sums.each() * sizeof(double);
    const std::size_t row = pixel * static_cast<std::size_t>(rows.width());
    const std::vector<std::string> names = channelsOfSums(sums.each(), sums.sums().planes());
    Imf::FrameBuffer buffer;
    auto name = names.begin();
    for (std::size_t plane = 0; plane < sums.sums().planes(); ++plane) {
        auto* const bytes = reinterpret_cast<char*>(const_cast<double*>(sums.sums().plane(plane).data()));
        for (std::size_t half = 0; half < 2 * sums.each(); ++half)
            buffer.insert(*name++,
                          Imf::Slice::Make(Imf::UINT, bytes + half * sizeof(std::uint32_t), place, pixel, row));
    }
    return buffer;
}

std::uint32_t crcOf(std::uint32_t before, const PixelSums& sums, const PixelBox& rows) {
    uLong crc = before;
    const std::size_t row = sums.each() * static_cast<std::size_t>(rows.width());
    for (std::size_t y = 0; y < static_cast<std::size_t>(rows.height()); ++y)
        for (std::size_t plane = 0; plane < sums.sums().planes(); ++plane)
            crc = ::crc32_z(crc, reinterpret_cast<const unsigned char*>(sums.sums().plane(plane).data() + y * row),
                            row * sizeof(double));
    return static_cast<std::uint32_t>(crc);
}

std::vector<std::string> addUp(const std::vector<PartFile>& parts, Film& film) {
    std::vector<std::string> problems;
    std::vector<SumsReader> readers(parts.begin(), parts.end());
    std::vector<bool> sound(parts.size(), true);
    const auto attempt = [&](std::size_t n, const auto& work) {
        try {
            if (sound[n]) work();
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
            sound[n] = false;
        }
    };
    const int spp = parts.front().part.whole.spp;
    for (const PixelBox& rows : bandsOf(film.region())) {
        PixelSums all;
        for (std::size_t n = 0; n < parts.size(); ++n)
            attempt(n, [&] {
                PixelSums share = readers[n].read(rows);
                if (all.pixels() == 0) {
                    all = std::move(share);
                    return;
                }
                for (std::size_t pixel = 0; pixel < all.pixels(); ++pixel) all.add(pixel, share, pixel);
            });
        std::size_t pixel = 0;
        if (!problems.empty()) continue;  // only to find what else is damaged
        for (int y = rows.y0; y < rows.y1; ++y)
            for (int x = rows.x0; x < rows.x1; ++x) all.store(pixel++, spp, film, x, y);
    }
    for (std::size_t n = 0; n < parts.size(); ++n) attempt(n, [&] { readers[n].check(); });
    return problems;
}

void checkSums(const PartFile& share) {
    SumsReader reader(share);
    for (const PixelBox& rows : bandsOf(share.part.piece)) (void)reader.read(rows);
    reader.check();
}

}  // namespace stratum::shade
