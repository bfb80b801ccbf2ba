#include "gcode/container/zip_archive.h"

#include "base/error.h"
#include "base/text.h"
#include "gcode/container/gzip.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

namespace stratum::gcode {
namespace {

using namespace std::string_view_literals;

constexpr zip_int64_t kMostEntries = 65536;
constexpr std::size_t kZipChunk = std::size_t{16} << 20;  // between two reports of progress

// libzip's error texts are valid only during the lifetime of the error object.
std::string reasonOf(zip_error_t& error) {
    std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    return reason;
}

// The N of "Metadata/plate_N.gcode", or 0.
int plateNumber(std::string_view entry) {
    constexpr auto before = "Metadata/plate_"sv;
    constexpr auto after = ".gcode"sv;
    if (!entry.starts_with(before) || !entry.ends_with(after) || entry.size() <= before.size() + after.size()) return 0;
    const std::string_view digits = entry.substr(before.size(), entry.size() - before.size() - after.size());
    return std::max(parsed<int>(digits).value_or(0), 0);
}

std::string listPlates(const std::vector<ZipPlate>& plates) {
    std::string list;
    for (std::size_t i = 0; i < plates.size(); ++i) list += fmt::format("{}{}", i == 0 ? "" : ", ", plates[i].number);
    return list;
}

// What a zip with that entry is, if it isn't a print that can be read.
std::string_view foreignKind(std::string_view entry) {
    constexpr std::array kKinds{
        std::pair{
            "Metadata/project_settings.config",
            "is a project of BambuStudio or OrcaSlicer that was saved without its G-code; open it there, slice it, "
            "and export the sliced plate"},
        std::pair{"Metadata/Slic3r_PE.config",
                  "is a project of PrusaSlicer, without G-code; open it there, slice it, and export the G-code"},
        std::pair{"Cura/version.ini",
                  "is a project of Cura, without G-code; open it there, slice it, and save to disk"},
        std::pair{"print.jsontoolpath",
                  "is a .makerbot file, whose moves are JSON of MakerBot's own; export .gcode or .x3g's source from a "
                  "slicer instead"},
        std::pair{"prusaslicer.ini", "is a picture stack of a resin printer; this program reads what a nozzle lays"},
        std::pair{"AndroidManifest.xml", "is an Android app, not a print"},
        std::pair{"word/document.xml", "is a Word document, not a print"},
    };
    for (const auto& [name, what] : kKinds)
        if (entry == name) return what;
    return {};
}

}  // namespace

ZipArchive openZipArchive(std::string_view bytes, std::string_view name) {
    zip_error_t error;
    zip_error_init(&error);
    const auto fail = [&]() {
        throw InputError(
            fmt::format("{}: zip container of {} bytes: its directory can't be read ({}); the file is cut off "
                        "or damaged: copy or export it again",
                        name, bytes.size(), reasonOf(error)));
    };
    zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
    if (source == nullptr) fail();
    ZipArchive archive(zip_open_from_source(source, ZIP_RDONLY, &error));
    if (!archive) {
        zip_source_free(source);
        fail();
    }
    zip_error_fini(&error);
    return archive;
}

ZipContents listZip(zip_t* archive, std::string_view name) {
    ZipContents contents;
    contents.entries = zip_get_num_entries(archive, 0);
    if (contents.entries > kMostEntries)
        throw InputError(fmt::format("{}: zip container with {} entries, more than {}; this is no print", name,
                                     contents.entries, kMostEntries));
    for (zip_int64_t i = 0; i < contents.entries; ++i) {
        const auto index = static_cast<zip_uint64_t>(i);
        const char* raw = zip_get_name(archive, index, ZIP_FL_ENC_RAW);
        if (raw == nullptr) continue;
        std::string_view entry = raw;
        if (entry.starts_with('/')) entry.remove_prefix(1);
        if (entry == "3D/model.gcode") contents.ufp_model = index;
        if (entry == "Metadata/slice_info.config") contents.slice_info = index;
        if (entry == "3D/_rels/model.gcode.rels") contents.relations = index;
        if (entry.starts_with("Materials/")) contents.materials.emplace_back(entry, index);
        if (entry == "3D/3dmodel.model") contents.model = true;
        if (contents.foreign.empty()) contents.foreign = foreignKind(entry);
        if (const int number = plateNumber(entry); number > 0) contents.plates.push_back({number, index});
    }
    std::sort(contents.plates.begin(), contents.plates.end(),
              [](const ZipPlate& a, const ZipPlate& b) { return a.number < b.number; });
    return contents;
}

const ZipPlate& chooseZipPlate(const std::vector<ZipPlate>& plates, std::string_view name, std::optional<int> wanted) {
    if (!wanted && plates.size() > 1)
        throw UsageError(fmt::format("{}: has {} plates ({}); choose one, e.g. --plate {}", name, plates.size(),
                                     listPlates(plates), plates.front().number));
    for (const ZipPlate& plate : plates)
        if (!wanted || plate.number == *wanted) return plate;
    throw UsageError(
        fmt::format("{}: --plate {}: there is no such plate; it has {}", name, *wanted, listPlates(plates)));
}

void unpackZipEntry(zip_t* archive, zip_uint64_t index, std::string_view name, std::size_t most, ByteBuffer& text,
                    const Progress& progress) {
    const char* raw = zip_get_name(archive, index, ZIP_FL_ENC_RAW);
    const std::string entry = raw != nullptr ? raw : "";
    const auto fail = [&](const std::string& what) { throw InputError(fmt::format("{}: {}: {}", name, entry, what)); };
    zip_stat_t status;
    zip_stat_init(&status);
    constexpr zip_uint64_t needed = ZIP_STAT_SIZE | ZIP_STAT_COMP_SIZE | ZIP_STAT_CRC;
    if (zip_stat_index(archive, index, 0, &status) != 0 || (status.valid & needed) != needed)
        fail("the zip directory does not state its size; copy or export the file again");
    if (status.size > most || status.size / kDeflateMostRatio > status.comp_size)
        fail(fmt::format("would unpack to {} bytes from {}, more than the {} of any print; unzip it to see what it is",
                         status.size, status.comp_size, most));
    const std::unique_ptr<zip_file_t, ZipDiscard> file(zip_fopen_index(archive, index, 0));
    if (!file && zip_error_code_zip(zip_get_error(archive)) == ZIP_ER_NOPASSWD)
        fail("is encrypted; unzip it with its password, or export the file again without one");
    if (!file) fail(fmt::format("can't be unzipped ({}); copy or export the file again", zip_strerror(archive)));
    // One byte more than the size: libzip checks size and CRC32 only in the read that reaches the end.
    char* const start = text.extend(status.size + 1);
    std::size_t done = 0;
    while (done <= status.size) {
        const zip_int64_t got =
            zip_fread(file.get(), start + done, std::min<zip_uint64_t>(status.size + 1 - done, kZipChunk));
        if (got < 0)
            fail(fmt::format("unzipping stops after {} of {} bytes ({}); the file is damaged: copy or export it again",
                             done, status.size, zip_file_strerror(file.get())));
        if (got == 0) break;
        done += static_cast<std::size_t>(got);
        if (progress) progress(std::min(1.0, static_cast<double>(done) / static_cast<double>(status.size)));
    }
    const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(start), std::min<std::size_t>(done, status.size));
    if (done != status.size || crc != status.crc)
        fail(fmt::format(
            "{} bytes with CRC32 {:08x}, expected {} with {:08x}; the file is damaged: copy or export it again", done,
            crc, status.size, status.crc));
    text.truncate(done);
}

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
    // Each file once, however often it is named: tools share materials.
    std::map<std::string, Material> materials;
    for (const std::string& path : materialPaths(unpackAside(archive, *contents.relations, name))) {
        const auto entry = std::find_if(contents.materials.begin(), contents.materials.end(),
                                        [&path](const auto& one) { return one.first == path; });
        if (entry == contents.materials.end()) continue;
        const auto [material, fresh] = materials.try_emplace(path);
        if (fresh) material->second = readMaterial(unpackAside(archive, entry->second, name));
        facts.stated.materials.push_back(material->second.name);
        facts.filament_colors.push_back(material->second.color);
    }
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
