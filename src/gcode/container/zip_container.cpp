#include "gcode/container/zip_container.h"

#include "base/error.h"
#include "gcode/container/zip_archive.h"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

using namespace std::string_view_literals;

// A small file beside the G-code; empty if it can't be read, because the print does not need it.
std::string unpackAside(zip_t* archive, zip_uint64_t index, std::string_view name) {
    constexpr std::size_t kMost = std::size_t{1} << 20;
    try {
        ByteBuffer text;
        unpackZipEntry(archive, index, name, kMost, text, {});
        return std::string(text.view());
    } catch (const InputError&) {
        return {};
    }
}

PackageFacts readMaterials(zip_t* archive, const ZipContents& contents, std::string_view name) {
    PackageFacts facts;
    if (!contents.relations) return facts;
    for (const std::string& path : materialPaths(unpackAside(archive, *contents.relations, name)))
        for (const auto& [entry, index] : contents.materials)
            if (entry == path) readMaterial(unpackAside(archive, index, name), facts);
    return facts;
}

}  // namespace

bool isZip(std::string_view bytes) { return bytes.starts_with("PK\x03\x04"sv) || bytes.starts_with("PK\x05\x06"sv); }

Program openZip(std::string_view bytes, std::string_view name, std::optional<int> plate, const ContainerLimits& limits,
                const Progress& progress) {
    const ZipArchive archive = openZipArchive(bytes, name);
    const ZipContents contents = listZip(archive.get(), name);
    Program program;
    zip_uint64_t index = 0;
    if (!contents.plates.empty()) {
        program.format = "3mf";
        const ZipPlate& chosen = chooseZipPlate(contents.plates, name, plate);
        index = chosen.index;
        if (contents.slice_info)
            program.facts = readSliceInfo(unpackAside(archive.get(), *contents.slice_info, name), chosen.number);
    } else if (contents.ufp_model) {
        program.format = "ufp";
        index = *contents.ufp_model;
        program.facts = readMaterials(archive.get(), contents, name);
    } else if (!contents.foreign.empty()) {
        throw InputError(fmt::format("{}: {}", name, contents.foreign));
    } else if (contents.model) {
        throw InputError(fmt::format("{}: is a 3MF model without G-code; slice it and export the sliced plate", name));
    } else {
        throw InputError(
            fmt::format("{}: is a zip container of {} entries, none of them Metadata/plate_N.gcode (3mf) or "
                        "/3D/model.gcode (ufp); unzip the G-code from it first",
                        name, contents.entries));
    }
    unpackZipEntry(archive.get(), index, name, limits.bytesFrom(bytes.size()), program.unpacked, progress);
    program.text = program.unpacked.view();
    return program;
}

}  // namespace stratum::gcode
