#include "shade/film/lossy_writers.h"

#include <cstddef>
#include <cstdio>  // jpeglib.h needs it before it

#include <jpeglib.h>

#include <fmt/format.h>

#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace stratum::shade {
namespace {

constexpr std::size_t kLongestComment = 65533;  // of the format

struct Failure {
    jpeg_error_mgr manager;
    std::jmp_buf back;
};

/// Trivially destructible, because libjpeg's errors longjmp over it.
struct Job {
    int width, height, quality;
    const std::uint8_t* rgb;
    const std::string* comments;
    std::size_t comment_count;
    unsigned char* bytes;
    unsigned long size;
};

/// False if libjpeg reported an error. The bytes are the caller's to free in any case.
bool run(Job& job) {
    jpeg_compress_struct jpeg{};
    Failure failure{};
    jpeg.err = jpeg_std_error(&failure.manager);
    failure.manager.error_exit = [](j_common_ptr common) {
        std::longjmp(reinterpret_cast<Failure*>(common->err)->back, 1);
    };
    failure.manager.output_message = [](j_common_ptr) {};
    if (setjmp(failure.back)) {
        jpeg_destroy_compress(&jpeg);
        return false;
    }
    jpeg_create_compress(&jpeg);
    jpeg_mem_dest(&jpeg, &job.bytes, &job.size);
    jpeg.image_width = static_cast<JDIMENSION>(job.width);
    jpeg.image_height = static_cast<JDIMENSION>(job.height);
    jpeg.input_components = 3;
    jpeg.in_color_space = JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, job.quality, TRUE);
    jpeg.comp_info[0].h_samp_factor = 1;
    jpeg.comp_info[0].v_samp_factor = 1;
    jpeg_start_compress(&jpeg, TRUE);
    for (std::size_t n = 0; n < job.comment_count; ++n)
        jpeg_write_marker(&jpeg, JPEG_COM, reinterpret_cast<const JOCTET*>(job.comments[n].data()),
                          static_cast<unsigned>(job.comments[n].size()));
    while (jpeg.next_scanline < jpeg.image_height) {
        const std::size_t at = std::size_t{3} * jpeg.next_scanline * jpeg.image_width;
        JSAMPROW row = const_cast<JSAMPROW>(job.rgb + at);  // is read only
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    return true;
}

}  // namespace

std::vector<std::uint8_t> encodeJpeg(int width, int height, const std::vector<std::uint8_t>& rgb, int quality,
                                     const std::map<std::string, std::string>& metadata) {
    if (width < 1 || height < 1 || rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw std::invalid_argument("these bytes are no RGB picture of that size");
    std::vector<std::string> comments;
    comments.reserve(metadata.size());
    for (const auto& [keyword, text] : metadata)
        comments.push_back(fmt::format("{}: {}", keyword, text).substr(0, kLongestComment));
    Job job{width, height, quality, rgb.data(), comments.data(), comments.size(), nullptr, 0};
    const bool done = run(job);
    const std::unique_ptr<unsigned char, decltype(&std::free)> owner(job.bytes, &std::free);
    if (!done) throw std::runtime_error("libjpeg can't encode the picture");
    return {job.bytes, job.bytes + job.size};
}

}  // namespace stratum::shade
