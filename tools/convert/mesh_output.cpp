#include "convert/mesh_output.h"

#include "base/error.h"
#include "export/mesh_file.h"
#include "gcode/slicer/bead_colors.h"
#include "gcode/toolpath/color.h"

#include <fmt/format.h>

#include <algorithm>

namespace stratum::tools {
namespace {

using exporter::MeshColors;

template <typename Grid>
const Grid* gridNamed(const openvdb::GridPtrVec& grids, voxelize::Attribute attribute) {
    for (const auto& grid : grids)
        if (grid->getName() == voxelize::attributeName(attribute)) return openvdb::gridPtrCast<Grid>(grid).get();
    return nullptr;
}

bool hasSeveralTools(const gcode::Toolpath& toolpath, std::span<const std::uint32_t> selection) {
    const auto tool_of = [&toolpath](std::uint32_t bead) { return toolpath.runOf(toolpath.beads[bead]).tool; };
    return std::any_of(selection.begin(), selection.end(),
                       [&](std::uint32_t bead) { return tool_of(bead) != tool_of(selection.front()); });
}

}  // namespace

void checkMeshGrids(const ConvertCommand& o, const std::filesystem::path& output) {
    const auto grids = voxelize::parseGrids(o.grids);
    if (grids.empty()) return;
    const bool colors = exporter::meshColors(output) != MeshColors::none;
    if (!colors || grids.size() > 1 || grids.front() != voxelize::Attribute::color)
        throw UsageError(fmt::format(
            "--grids {}: a mesh has no voxels; write a .vdb, not {}{}", o.grids, output.string(),
            colors ? ", or give --grids color" : ", or a .ply, .obj, .3mf, .glb or .usda with --grids color"));
}

void noteOutput(const ConvertCommand& o, const std::filesystem::path& output, std::string_view option,
                RunFiles& files) {
    files.writes(output.string(), option);
    if (o.color.empty() && voxelize::parseGrids(o.grids).empty()) return;
    if (const auto companion = exporter::meshCompanion(output)) files.writes(companion->string(), option);
}

std::vector<voxelize::Attribute> meshAttributes(const ConvertCommand& o, const gcode::Toolpath& toolpath,
                                                std::span<const std::uint32_t> selection,
                                                const std::filesystem::path& output) {
    const MeshColors kind = exporter::meshColors(output);
    const bool asked = !voxelize::parseGrids(o.grids).empty();
    const bool wanted = asked || (o.grids.empty() && (kind == MeshColors::materials || !o.color.empty()));
    if (kind == MeshColors::none || !wanted) return {};
    // Always by its points, as it was asked for.
    if (kind == MeshColors::points && asked) return {voxelize::Attribute::color};
    if (gcode::distinctColors(toolpath, selection).size() < 2 && !hasSeveralTools(toolpath, selection)) return {};
    if (kind == MeshColors::points) return {voxelize::Attribute::color};
    return {voxelize::Attribute::color, voxelize::Attribute::tool};
}

std::vector<exporter::MeshMaterial> materialsOf(const gcode::Toolpath& toolpath,
                                                std::span<const std::uint32_t> selection) {
    std::vector<gcode::StatedColor> stated = gcode::statedColors(toolpath, selection);
    std::erase_if(stated, [](const gcode::StatedColor& color) { return !color.color; });
    std::vector<exporter::MeshMaterial> materials;
    materials.reserve(stated.size());
    for (const gcode::StatedColor& color : stated) {
        const auto of_tool = std::count_if(stated.begin(), stated.end(), [&color](const gcode::StatedColor& other) {
            return other.tool == color.tool;
        });
        materials.push_back({of_tool > 1
                                 ? fmt::format("tool_{}_{}", color.tool, gcode::colorText(*color.color).substr(1))
                                 : fmt::format("tool_{}", color.tool),
                             *color.color});
    }
    return materials;
}

exporter::SurfaceMesh meshOf(const ConvertCommand& o, const openvdb::FloatGrid& grid, const openvdb::GridPtrVec& grids,
                             bool culled, const std::vector<exporter::MeshMaterial>& materials,
                             const std::filesystem::path& output) {
    exporter::MeshOptions options{culled, o.mesh_error, o.mesh_faces};
    options.color = gridNamed<openvdb::Vec3SGrid>(grids, voxelize::Attribute::color);
    options.tool = gridNamed<openvdb::Int32Grid>(grids, voxelize::Attribute::tool);
    exporter::SurfaceMesh mesh = exporter::meshSurface(grid, options);
    const MeshColors kind = exporter::meshColors(output);
    const bool optional = kind == MeshColors::optional_materials && (!o.grids.empty() || !o.color.empty());
    const bool surface_alone = !o.grids.empty() && voxelize::parseGrids(o.grids).empty();
    if (options.color == nullptr && materials.size() == 1 && !surface_alone &&
        (kind == MeshColors::materials || optional))
        mesh.materials = materials;
    return mesh;
}

}  // namespace stratum::tools
