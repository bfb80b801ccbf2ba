// libFuzzer: any bytes as a part of a picture. Only InputError may come out of reading what it says, and of reading its
// pixels into a picture that is as large as it says.
//
// How to build and run it stands in scripts/fuzz.sh.
#include "base/error.h"
#include "fuzz/memory_file.h"
#include "shade/parts/part.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace stratum::shade;
    const stratum::test::MemoryFile file({reinterpret_cast<const char*>(data), size});
    try {
        const Part part = readPart(file.path());
        if (!differenceOf(part, part).empty()) __builtin_trap();
        Film film(part.whole.width, part.whole.height, part.piece, part.content);
        addLayers(part, film);
        readPixels(file.path(), part, film);
    } catch (const stratum::InputError&) {
    }
    return 0;
}
