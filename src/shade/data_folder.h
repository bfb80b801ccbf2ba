// Where the tables are that come with the project.
#pragma once

#include <filesystem>

namespace stratum::shade {

/// $STRATUM_DATA, or `share/stratum/data` beside the program or the Python module, or `data` of the sources that it was
/// built from.
std::filesystem::path dataFolder();

}  // namespace stratum::shade
