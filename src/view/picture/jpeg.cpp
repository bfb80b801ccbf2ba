#include "view/picture/jpeg.h"

#include <cstddef>
#include <cstdio>  // jpeglib.h needs it before it

#include <jpeglib.h>

#include <csetjmp>
#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace stratum::view {
namespace {

struct Failure {
    jpeg_error_mgr manager;
    std::jmp_buf back;
};

/// Trivially destructible, because libjpeg's errors longjmp over it.
struct Job {
    int width, height, quality;
    const std::uint8_t* rgb;
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
    // Edges between colours stay sharp.
    jpeg.comp_info[0].h_samp_factor = 1;
    jpeg.comp_info[0].v_samp_factor = 1;
    jpeg.dct_method = JDCT_IFAST;
    jpeg_start_compress(&jpeg, TRUE);
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

std::vector<std::uint8_t> encodeJpeg(int width, int height, const std::vector<std::uint8_t>& rgb, int quality) {
    if (width < 1 || height < 1 || rgb.size() != 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
        throw std::invalid_argument("these bytes are no RGB picture of that size");
    Job job{width, height, quality, rgb.data(), nullptr, 0};
    const bool done = run(job);
    const std::unique_ptr<unsigned char, decltype(&std::free)> owner(job.bytes, &std::free);
    if (!done) throw std::runtime_error("the picture could not be encoded as JPEG");
    return {job.bytes, job.bytes + job.size};
}

}  // namespace stratum::view
