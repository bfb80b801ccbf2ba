#include "corpus.h"

namespace stratum::test {

std::filesystem::path sourceDir() { return STRATUM_SOURCE_DIR; }

}  // namespace stratum::test
