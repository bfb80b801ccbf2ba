// libFuzzer: any bytes as a container, and what comes out as a program. Only InputError and UsageError may come
// out of it.
//
// FOLDER collects the inputs that reach new code; start it with a copy of tests/fuzz/container, which the tests run too
// and whose successor comes out of:
//   container_fuzz -set_cover_merge=1 -use_counters=0 -max_len=4096 NEW tests/fuzz/container FOLDER
// Checksums are what a fuzzer can't guess, so the CRC32s of a binary G-code file are put right before it is read.
//
// How to build and run it stands in scripts/fuzz.sh.
#include "base/error.h"
#include "gcode/container/bgcode.h"
#include "gcode/container/container.h"
#include "gcode/container/little_endian.h"
#include "gcode/reader.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

namespace {

using stratum::gcode::littleEndian;

// Mends the CRC32 behind every block that is whole, and leaves alone what comes after the first that is not.
void mendChecksums(std::string& bytes) {
    if (bytes.size() < 10 || bytes[8] != 1) return;
    for (std::size_t at = 10; at + 8 <= bytes.size();) {
        const bool packed = littleEndian(bytes, at + 2, 2) != 0;
        if (packed && at + 12 > bytes.size()) return;
        const std::size_t stored = littleEndian(bytes, at + (packed ? 8 : 4), 4);
        const std::size_t size = (packed ? 12 : 8) + (littleEndian(bytes, at, 2) == 5 ? 6 : 2) + stored;
        if (bytes.size() - at < size + 4) return;
        const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data() + at), size);
        for (std::size_t i = 0; i < 4; ++i) bytes[at + size + i] = static_cast<char>(crc >> (8 * i) & 0xff);
        at += size + 4;
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string bytes(reinterpret_cast<const char*>(data), size);
    if (stratum::gcode::isBgcode(bytes)) mendChecksums(bytes);
    stratum::gcode::ContainerLimits limits;
    limits.most_bytes = limits.any_ratio_bytes = std::size_t{1} << 22;  // large outputs find nothing, slowly
    try {
        const stratum::gcode::Program program = stratum::gcode::openContainer(bytes, "fuzz", {}, limits);
        if (program.text.size() > limits.most_bytes + program.metadata.size() * 64 + bytes.size()) __builtin_trap();
        if (program.text.size() < (std::size_t{1} << 18)) stratum::gcode::readToolpath(program.text, "fuzz");
    } catch (const stratum::InputError&) {
    } catch (const stratum::UsageError&) {
    }
    return 0;
}
