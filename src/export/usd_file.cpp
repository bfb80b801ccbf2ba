#include "export/usd_file.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/own_file.h"
#include "export/mesh/mesh_formats.h"

#include <fmt/format.h>

#include <string>

namespace stratum::exporter {
namespace {

// USD's names of value types.
std::string dataType(const openvdb::GridBase& grid) {
    if (grid.isType<openvdb::Vec3SGrid>()) return "float3";
    if (grid.isType<openvdb::Int32Grid>()) return "int";
    return "float";
}

std::string field(const openvdb::GridBase& grid, const std::string& file) {
    const std::string name = grid.getName();
    std::string text = fmt::format(
        "    def OpenVDBAsset \"{0}\"\n    {{\n        asset filePath = @./{1}@\n        token fieldName = \"{0}\"\n"
        "        int fieldIndex = 0\n        token fieldDataType = \"{2}\"\n",
        name, file, dataType(grid));
    if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) text += "        token fieldClass = \"levelSet\"\n";
    if (dataType(grid) == "float3") text += "        token vectorDataRoleHint = \"Color\"\n";
    return text + "    }\n";
}

// Of a grid that went to its file without being in memory, its metadata tell.
openvdb::CoordBBox activeBoxOf(const openvdb::GridBase& grid) {
    const auto low = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MIN);
    const auto high = grid.getMetadata<openvdb::Vec3IMetadata>(openvdb::GridBase::META_FILE_BBOX_MAX);
    if (!grid.empty() || !low || !high) return grid.evalActiveVoxelBoundingBox();
    return {openvdb::Coord(low->value()), openvdb::Coord(high->value())};
}

}  // namespace

void writeUsda(const openvdb::GridPtrVec& grids, const std::filesystem::path& vdb, const std::filesystem::path& usda,
               const UsdOptions& options) {
    const std::string name = vdb.filename().string();
    // USD would end the path there.
    if (name.find('@') != std::string::npos)
        throw OutputError(fmt::format("{}: a .usda can't name a file with @ in it; choose another -o", name));
    openvdb::BBoxd box;
    for (const auto& grid : grids) {
        const openvdb::CoordBBox active = activeBoxOf(*grid);
        box.expand(grid->transform().indexToWorld(openvdb::BBoxd(active.min().asVec3d(), active.max().asVec3d())));
    }
    const auto low = box.min();
    const auto high = box.max();
    const bool bound = options.materials.size() == 1;
    std::string text = fmt::format(
        "#usda 1.0\n(\n    defaultPrim = \"print\"\n    doc = \"by {}\"\n    metersPerUnit = {}\n    upAxis = "
        "\"{}\"\n)\n\n"
        "def Volume \"print\" (\n{}    kind = \"component\"\n)\n{{\n"
        "    float3[] extent = [({}, {}, {}), ({}, {}, {})]\n",
        kProgramMark, options.meters_per_unit, options.up_y ? "Y" : "Z",
        bound ? "    prepend apiSchemas = [\"MaterialBindingAPI\"]\n" : "", low[0], low[1], low[2], high[0], high[1],
        high[2]);
    if (bound)
        text += fmt::format("    rel material:binding = </print/materials/{}>\n", options.materials.front().name);
    for (const auto& grid : grids) text += fmt::format("    rel field:{0} = </print/{0}>\n", grid->getName());
    for (const auto& grid : grids) {
        text += '\n';
        text += field(*grid, name);
    }
    text += usdMaterials(options.materials, "/print");
    text += "}\n";

    writeFile(usda, text);
}

}  // namespace stratum::exporter
