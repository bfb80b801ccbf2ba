// Options of Python -> a picture.
#pragma once

#include "python/options/keywords.h"

#include "assemble/picture_request.h"

#include <string>
#include <vector>

namespace stratum::python {

/// All that render() takes besides its source.
struct RenderCall : assemble::PictureRequest {
    /// Names of options that are given: of G-code alone; of its reading.
    std::vector<std::string> of_prints, of_reading;
};

/// As vdbtrace's options of those names. Throws UsageError.
RenderCall renderCallOf(Keywords& options);

}  // namespace stratum::python
