#include "python/options/picture_options.h"

#include "assemble/print/read_print_options.h"

#include <cstddef>

namespace stratum::python {

RenderCall renderCallOf(Keywords& options) {
    RenderCall call;
    assemble::readPicture(options, call);
    assemble::refuseUnused(options, call);
    assemble::completeSamples(call);
    const auto since = [&options](std::size_t begin) {
        return std::vector<std::string>(options.found().begin() + static_cast<std::ptrdiff_t>(begin),
                                        options.found().end());
    };
    std::size_t begin = options.found().size();
    voxelize::PrintOptions& print = call.tracing.prints.print;
    assemble::readConversion(options, print, true);
    assign(call.tracing.prints.printed, options.text("printed"));
    call.of_prints = since(begin);
    begin = options.found().size();
    assemble::readReading(options, print);
    call.of_reading = since(begin);
    call.find_exposure = !call.exposure;
    return call;
}

}  // namespace stratum::python
