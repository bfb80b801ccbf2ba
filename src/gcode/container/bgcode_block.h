// Reads the blocks of a binary G-code file: bounds, checksums, decompression. bgcode.cpp interprets them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stratum::gcode {

enum class BlockType : std::uint16_t {
    file_metadata,
    gcode,
    slicer_metadata,
    printer_metadata,
    print_metadata,
    thumbnail
};
enum class BlockCompression : std::uint16_t { none, deflate, heatshrink_11_4, heatshrink_12_4 };

struct Block {
    std::size_t index = 0;   ///< 1, 2, ... in the file
    std::size_t offset = 0;  ///< of its header in the file
    BlockType type = BlockType::file_metadata;
    BlockCompression compression = BlockCompression::none;
    std::uint16_t encoding = 0;  ///< the first of its parameters
    std::size_t size = 0;        ///< of the data once unpacked
    std::string_view data;       ///< as stored
};

/// Walks over the blocks of one file. Errors are InputErrors that start with the file's name.
class BlockReader {
public:
    /// Checks the file header. `bytes` and `name` must outlive the reader.
    BlockReader(std::string_view bytes, std::string_view name);

    /// Reads the next block's header and checks its sizes and its CRC32; false at the end of the file.
    bool next(Block& block);

    /// Undoes the compression. `out` has block.size bytes.
    void unpack(const Block& block, std::span<char> out) const;

    /// Throws an InputError that names the block, its byte offset and the fault.
    [[noreturn]] void fail(const Block& block, std::string_view what) const;

private:
    std::string_view bytes_;
    std::string_view name_;
    std::size_t at_ = 0;
    std::size_t count_ = 0;
    bool checksums_ = false;
};

}  // namespace stratum::gcode
