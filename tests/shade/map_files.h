// Environment maps written by the tests.
#pragma once

#include "scratch_folder.h"
#include "shade/color.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace stratum::test {

/// A Radiance picture without run lengths.
inline std::string hdrBytes(const std::string& header, int width, int height, const std::vector<shade::Color>& texels) {
    std::string bytes = header + "\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
    for (const shade::Color& c : texels) {
        int exponent = 0;
        const float peak = shade::maxComponent(c);
        if (peak > 0.0f) std::frexp(peak, &exponent);
        for (int k = 0; k < 3; ++k)
            bytes.push_back(static_cast<char>(static_cast<unsigned char>(std::ldexp(c[k], 8 - exponent))));
        bytes.push_back(static_cast<char>(static_cast<unsigned char>(peak > 0.0f ? exponent + 128 : 0)));
    }
    return bytes;
}

inline void writeExrMap(const std::filesystem::path& path, int width, int height, std::vector<shade::Color> texels,
                        const std::map<std::string, std::string>& attributes = {}) {
    Imf::Header header(width, height);
    for (const auto& [name, text] : attributes) header.insert(name.c_str(), Imf::StringAttribute(text));
    Imf::FrameBuffer buffer;
    const char* names[] = {"R", "G", "B"};
    for (int c = 0; c < 3; ++c) {
        header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
        buffer.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&texels[0][c]), sizeof(shade::Color),
                                           sizeof(shade::Color) * static_cast<std::size_t>(width)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
}

}  // namespace stratum::test
