// libFuzzer: any text as the file of a printer. Only InputError may come out of reading it, and what is read must be
// limits that a planner can work with.
//
// How to build and run it stands in scripts/fuzz.sh. Includes of Klipper are read, too: of files that happen to be
// there.
#include "base/error.h"
#include "deposit/printer.h"
#include "fuzz/memory_file.h"
#include "fuzz/require.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace {

void check(const stratum::gcode::PrinterLimits& printer) {
    using namespace stratum::gcode;
    for (std::size_t n = 0; n < kLimitCount; ++n) {
        const auto limit = static_cast<Limit>(n);
        const LimitOrigin& origin = printer.origins[limit];
        const double value = valueOf(printer.limits, limit);
        require(!std::isnan(value) && value >= 0);
        if (origin.kind != LimitOrigin::Kind::printer) continue;
        const Bounds bounds = boundsOf(limit);
        require(value >= bounds.least && value <= bounds.most && !origin.place.empty());
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const stratum::test::MemoryFile file(text);
    stratum::gcode::ReadOptions options;
    try {
        stratum::deposit::usePrinter(file.path(), options);
    } catch (const stratum::InputError&) {
        return 0;
    }
    if (options.printer) check(*options.printer);
    return 0;
}
