#include "build_facts.h"

#include <ImfVersion.h>
#include <OpenEXRConfig.h>
#include <blosc.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/highway.h>
#include <openvdb/version.h>
#include <png.h>
#include <tbb/version.h>
#include <zlib.h>
#include <CLI/Version.hpp>
#include <nlohmann/json.hpp>

#include <vector>

namespace stratum::tools {
namespace {

std::string simdTargets() {
    std::vector<std::string> names;
    for (std::int64_t rest = hwy::SupportedTargets(); rest != 0; rest &= rest - 1)
        names.emplace_back(hwy::TargetName(rest & -rest));
    return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string buildFacts(const std::string& tool) {
#if defined(__clang__)
    const char* compiler = "Clang " __clang_version__;
#else
    const char* compiler = "GCC " __VERSION__;
#endif
    return fmt::format(
        "{} {}\ncompiler   {}, {}{}\nSIMD       {} (of this machine, best first)\n"
        "libraries  OpenVDB {}.{}.{}, oneTBB {}, OpenEXR {}, Highway {}.{}.{}, Blosc {}, zlib {}, libpng {}, fmt "
        "{}.{}.{}, nlohmann-json {}.{}.{}, CLI11 {}",
        tool, STRATUM_VERSION, compiler, STRATUM_BUILD_TYPE,
        *STRATUM_SANITIZERS != '\0' ? ", -fsanitize=" STRATUM_SANITIZERS : "", simdTargets(),
        OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER, OPENVDB_LIBRARY_MINOR_VERSION_NUMBER,
        OPENVDB_LIBRARY_PATCH_VERSION_NUMBER, TBB_VERSION_STRING, OPENEXR_VERSION_STRING, HWY_MAJOR, HWY_MINOR,
        HWY_PATCH, BLOSC_VERSION_STRING, ZLIB_VERSION, PNG_LIBPNG_VER_STRING, FMT_VERSION / 10000,
        FMT_VERSION / 100 % 100, FMT_VERSION % 100, NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
        NLOHMANN_JSON_VERSION_PATCH, CLI11_VERSION);
}

}  // namespace stratum::tools
