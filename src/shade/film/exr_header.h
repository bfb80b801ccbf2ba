// Checks the sizes in an OpenEXR file's header against the size of the file.
#pragma once

#include <cstddef>
#include <string_view>

namespace stratum::shade {

/// OpenEXR allocates memory for tables, lines and attributes as stated in the header, before it reads the data: a file
/// of a hundred bytes can request gigabytes. This checks the headers of all parts first.
/// Throws InputError, beginning with `name`: an attribute that is longer than the file, a picture of more than `most`
/// pixels or wider or higher than 2^17, more chunks than fit into the file, more data than the bytes can unpack to
/// (2048 times their number, 65536 times with DWA compression; a picture of one color takes a tenth of that), deep
/// data.
void checkExrHeader(std::string_view bytes, std::size_t most, std::string_view name);

}  // namespace stratum::shade
