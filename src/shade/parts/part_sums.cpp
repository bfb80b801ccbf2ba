#include "shade/parts/part_sums.h"

#include "base/checksum.h"
#include "base/error.h"
#include "base/parallel_for.h"

#include <ImfInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <exception>
#include <utility>

namespace stratum::shade {
namespace {

// OpenEXR unpacks 16 rows at once. Some more, since each time all files are opened anew: there may be too many to keep
// them open.
constexpr int kRows = 32;

/// One share, read by rows, in any order and by any thread.
class SumsReader {
public:
    explicit SumsReader(const PartFile& file) : file_(file), aovs_(aovsOf(file.part)) {}

    PixelSums read(const PixelBox& rows) const {
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
        return sums;
    }
    /// `crcs`: of the rows of each band. Throws InputError.
    void check(const std::vector<PixelBox>& bands, const std::vector<std::uint32_t>& crcs) const {
        std::uint32_t crc = file_.part.head;
        for (std::size_t n = 0; n < bands.size(); ++n) {
            const PixelSums one(1, aovs_);
            const auto pixels =
                static_cast<std::uint64_t>(bands[n].width()) * static_cast<std::uint64_t>(bands[n].height());
            crc = checksumOfBoth(crc, crcs[n], pixels * one.each() * file_.part.planes * sizeof(double));
        }
        if (crc != file_.part.crc)
            throw InputError(
                fmt::format("{}: is damaged (its checksum is wrong); trace this shard again", file_.path.string()));
    }

private:
    const PartFile& file_;
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
    std::uint32_t crc = before;
    const std::size_t row = sums.each() * static_cast<std::size_t>(rows.width());
    for (std::size_t y = 0; y < static_cast<std::size_t>(rows.height()); ++y)
        for (std::size_t plane = 0; plane < sums.sums().planes(); ++plane)
            crc = checksumOf(sums.sums().plane(plane).data() + y * row, row, crc);
    return crc;
}

std::vector<std::string> addUp(const std::vector<PartFile>& parts, Film& film) {
    const std::vector<SumsReader> readers(parts.begin(), parts.end());
    const std::vector<PixelBox> bands = bandsOf(film.region());
    const int spp = parts.front().part.whole.spp;
    std::vector<std::vector<std::uint32_t>> crcs(parts.size(), std::vector<std::uint32_t>(bands.size()));
    // By part and band; mostly empty.
    std::vector<std::vector<std::string>> found(parts.size(), std::vector<std::string>(bands.size()));
    parallelFor(bands.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t band = first; band < last; ++band) {
            const PixelBox& rows = bands[band];
            PixelSums all;
            bool sound = true;
            for (std::size_t n = 0; n < parts.size(); ++n) {
                try {
                    PixelSums share = readers[n].read(rows);
                    crcs[n][band] = crcOf(0, share, rows);
                    if (all.pixels() == 0) {
                        all = std::move(share);
                        continue;
                    }
                    for (std::size_t pixel = 0; pixel < all.pixels(); ++pixel) all.add(pixel, share, pixel);
                } catch (const InputError& error) {
                    found[n][band] = error.what();
                    sound = false;
                }
            }
            if (!sound) continue;
            std::size_t pixel = 0;
            for (int y = rows.y0; y < rows.y1; ++y)
                for (int x = rows.x0; x < rows.x1; ++x) all.store(pixel++, spp, film, x, y);
        }
    });
    std::vector<std::string> problems;
    for (std::size_t n = 0; n < parts.size(); ++n) {
        const auto problem =
            std::find_if(found[n].begin(), found[n].end(), [](const std::string& text) { return !text.empty(); });
        try {
            if (problem != found[n].end())
                problems.push_back(*problem);
            else
                readers[n].check(bands, crcs[n]);
        } catch (const InputError& error) {
            problems.emplace_back(error.what());
        }
    }
    return problems;
}

void checkSums(const PartFile& share) {
    const SumsReader reader(share);
    const std::vector<PixelBox> bands = bandsOf(share.part.piece);
    std::vector<std::uint32_t> crcs(bands.size());
    parallelFor(bands.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t band = first; band < last; ++band)
            crcs[band] = crcOf(0, reader.read(bands[band]), bands[band]);
    });
    reader.check(bands, crcs);
}

}  // namespace stratum::shade
