// The parameters of functions and their defaults, as inspect.signature() and help() tell them.
#pragma once

#include "python/options/keywords.h"

#include "assemble/print/read_print_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <string_view>

namespace stratum::python {

/// "size=None, spp=None": what `read` asks for where nothing is given.
template <typename Read>
std::string parametersOf(const Read& read) {
    const pybind11::kwargs none;
    Keywords options("signature", none);
    read(options);
    return fmt::format("{}=None", fmt::join(options.known(), "=None, "));
}

/// Those of assemble::readReading().
inline std::string readingParameters() {
    voxelize::PrintOptions print;
    return parametersOf([&](Keywords& options) { assemble::readReading(options, print); });
}

/// Those of assemble::readConversion().
inline std::string conversionParameters() {
    voxelize::PrintOptions print;
    return parametersOf([&](Keywords& options) { assemble::readConversion(options, print); });
}

/// A docstring that begins with what Python takes for its __text_signature__.
/// @param call  "name(parameters)", of which Python sees the first
inline std::string documented(std::string_view call, std::string_view text) {
    return fmt::format("{}\n--\n\n{}", call, text);
}

}  // namespace stratum::python
