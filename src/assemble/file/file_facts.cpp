#include "assemble/file/file_facts.h"

#include "base/checksum.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "march/file/grid_axes.h"
#include "march/file/vdb_walker.h"
#include "voxelize/beads/part_outline.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

namespace stratum::assemble {
namespace fs = std::filesystem;

bool isVdbFile(const std::string& path) {
    return !gcode::isStream(path) && InputFile(path).first(march::kVdbMagic.size()) == march::kVdbMagic;
}

std::string unitOf(const openvdb::FloatGrid& grid) {
    const auto unit = grid.getMetadata<openvdb::StringMetadata>("unit");
    return unit ? unit->value() : "world units";
}

std::string upOf(const openvdb::FloatGrid& grid) {
    const auto up = grid.getMetadata<openvdb::StringMetadata>("up");
    return up ? up->value() : "z";
}

std::optional<trace::Box> partOf(const openvdb::FloatGrid& grid) {
    const auto low = grid.getMetadata<openvdb::Vec3DMetadata>("part_bbox_min");
    const auto high = grid.getMetadata<openvdb::Vec3DMetadata>("part_bbox_max");
    if (!low || !high) return std::nullopt;
    const openvdb::Vec3d& a = low->value();
    const openvdb::Vec3d& b = high->value();
    if (!a.isFinite() || !b.isFinite() || a[0] > b[0] || a[1] > b[1] || a[2] > b[2]) return std::nullopt;
    return trace::Box{{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

std::vector<glm::dvec3> outlineOf(const openvdb::FloatGrid& grid) {
    std::vector<glm::dvec3> outline;
    if (const auto text = grid.getMetadata<openvdb::StringMetadata>("part_outline"))
        for (const auto& [x, y, z] : voxelize::outlineFromText(text->value())) outline.emplace_back(x, y, z);
    return outline;
}

std::string thinBandWarning(const std::string& path, const openvdb::FloatGrid& grid) {
    const double half_width = static_cast<double>(grid.background()) / march::GridAxes(grid.transform()).shortest();
    // Rounding of the background to a float is no reason to warn.
    if (half_width >= 2.999) return {};
    return fmt::format(
        "{}: the narrow band is {:.2f} voxels to each side; with less than 3, surfaces that bend sharply may have "
        "holes; "
        "make it again with gcode2vdb --half-width 3",
        path, half_width);
}

std::string identityOf(const std::string& path) {
    std::error_code missing;
    if (!fs::is_regular_file(path, missing)) return {};
    const auto changed = fs::last_write_time(path, missing).time_since_epoch().count();
    const InputFile file(path);
    constexpr std::size_t kEnd = std::size_t{1} << 16;
    file.load(0, std::min(file.size(), kEnd));
    file.load(file.size() - std::min(file.size(), kEnd), std::min(file.size(), kEnd));
    const std::string_view bytes = file.unread();
    return fmt::format("{} {} {} {}", bytes.size(), changed, sha256Hex(bytes.substr(0, kEnd)),
                       sha256Hex(bytes.substr(bytes.size() - std::min(bytes.size(), kEnd))));
}

}  // namespace stratum::assemble
