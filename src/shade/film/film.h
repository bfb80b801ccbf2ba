// A film: linear RGB and coverage for every pixel.
#pragma once

#include "shade/color.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace stratum::shade {

/// A rectangle of pixels, x0 <= x < x1 and y0 <= y < y1; (0, 0) is the upper left pixel.
struct PixelBox {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    bool operator==(const PixelBox&) const = default;
};

/// The meaning of the values, for conversion into a viewable picture.
enum class FilmContent {
    radiance,  ///< light; needs exposure and tone mapping
    unit,      ///< a share in [0, 1], e.g. ambient occlusion
    normal,    ///< world-space unit vectors, components in [-1, 1], times alpha
    depth,     ///< distance along the ray in world units, times alpha
    position,  ///< world-space position in world units, times alpha
};

/// Mean values of one pixel. rgb is premultiplied by alpha.
struct Pixel {
    Color rgb{0.0f};
    float alpha = 0.0f;
};

/// A named set of channels beside the picture, e.g. "normal" with X, Y, Z.
struct FilmLayer {
    std::string name;
    std::vector<std::string> channels;
    std::vector<float> values;  ///< channel fastest, then pixels row by row from the top
};

/// The finished pixels of one region of a frame. Different pixels may be written by different threads.
class Film {
public:
    Film() = default;
    /// @param frame_width, frame_height  pixels of the whole picture
    /// @param region                     the part that this film holds, inside the frame
    Film(int frame_width, int frame_height, const PixelBox& region, FilmContent content = FilmContent::radiance);

    int frameWidth() const { return frame_width_; }
    int frameHeight() const { return frame_height_; }
    const PixelBox& region() const { return region_; }
    FilmContent content() const { return content_; }
    int width() const { return region_.width(); }
    int height() const { return region_.height(); }

    /// Coordinates of the frame, not of the region.
    Pixel& at(int x, int y) { return pixels_[index(x, y)]; }
    const Pixel& at(int x, int y) const { return pixels_[index(x, y)]; }
    /// Row by row from the top.
    std::vector<Pixel>& pixels() { return pixels_; }
    const std::vector<Pixel>& pixels() const { return pixels_; }
    /// The index of a pixel in pixels() and in each layer.
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - region_.y0) * static_cast<std::size_t>(region_.width()) +
               static_cast<std::size_t>(x - region_.x0);
    }
    /// The film of a smaller region, inside this one's.
    Film part(const PixelBox& region) const;
    std::vector<FilmLayer>& layers() { return layers_; }
    const std::vector<FilmLayer>& layers() const { return layers_; }

    /// Whether nothing is to be seen behind the print: pictures to look at then keep alpha.
    bool transparent() const { return bare_bed_.has_value(); }
    /// Of a transparent film, the luminance of what shadows fall on, where nothing shades it: what light a pixel stands
    /// for is that of rgb and (1 - alpha) of this. 0 without a bed.
    float bareBed() const { return bare_bed_.value_or(0.0f); }
    void makeTransparent(float bare_bed) { bare_bed_ = bare_bed; }

private:
    int frame_width_ = 0, frame_height_ = 0;
    PixelBox region_;
    FilmContent content_ = FilmContent::radiance;
    std::vector<Pixel> pixels_;
    std::vector<FilmLayer> layers_;
    std::optional<float> bare_bed_;
};

}  // namespace stratum::shade
