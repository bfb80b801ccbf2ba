// What needs OpenEXR's own types: a file in memory for its readers, so that the bytes that were checked are those that
// are read, and the channels of a film.
#pragma once

#include "shade/film/film.h"

#include <Iex.h>
#include <ImfFrameBuffer.h>
#include <ImfIO.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace stratum::shade {

/// Reads bytes that outlive it.
class ExrBytes final : public Imf::IStream {
public:
    ExrBytes(std::string_view bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

    bool read(char to[], int count) override {
        const auto wanted = static_cast<std::size_t>(count);
        if (count < 0 || wanted > bytes_.size() - at_) throw Iex::InputExc("the file ends early");
        std::memcpy(to, bytes_.data() + at_, wanted);
        at_ += wanted;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t place) override {
        if (place > bytes_.size()) throw Iex::InputExc("the file ends early");
        at_ = static_cast<std::size_t>(place);
    }

private:
    const std::string_view bytes_;
    std::size_t at_ = 0;
};

/// R, G, B, A and LAYER.CHANNEL of all layers, at the places of the film's region. A file whose data window lies in
/// the region is read into its place. OpenEXR's buffers are never const; for writing the film isn't changed.
Imf::FrameBuffer exrBufferOf(const Film& film);

}  // namespace stratum::shade
