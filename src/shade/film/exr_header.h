// What an OpenEXR file says of its own size, against the bytes that are there.
#pragma once

#include <cstddef>
#include <string_view>

namespace stratum::shade {

/// OpenEXR takes memory for tables, lines and attributes as the header asks for it, before it looks at the data: a file
/// of a hundred bytes can ask for gigabytes. This walks the headers of all parts first.
/// Throws InputError, beginning with `name`: an attribute that is longer than the file, a picture of more than `most`
/// pixels or wider or higher than 2^17, chunks that can't all be there, more data than so few bytes can be packed from
/// (2048 times their number, 65536 times with DWA compression; a picture of one colour takes a tenth of that), deep
/// data.
void checkExrHeader(std::string_view bytes, std::size_t most, std::string_view name);

}  // namespace stratum::shade
