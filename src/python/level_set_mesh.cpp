#include "python/level_set_mesh.h"

#include "python/arrays.h"
#include "python/long_call.h"
#include "python/named_tuple.h"

#include "base/error.h"
#include "export/mesh/surface_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace stratum::python {

namespace py = pybind11;

namespace {

// A color each point, sRGB; None if nothing is known of them.
py::object colorsOf(const exporter::SurfaceMesh& mesh) {
    if (mesh.materials.empty()) return py::none();
    std::vector<std::uint8_t> colors(3 * mesh.points.size());
    for (std::size_t n = 0; n < mesh.points.size(); ++n) {
        const std::size_t material = mesh.material_of_point.empty() ? 0 : mesh.material_of_point[n];
        std::ranges::copy(mesh.materials[material].color, colors.begin() + static_cast<std::ptrdiff_t>(3 * n));
    }
    const auto count = static_cast<py::ssize_t>(mesh.points.size());
    return arrayOf(std::move(colors), {count, 3});
}

}  // namespace

py::object meshOf(const LevelSetObject& self, double mesh_error, bool outside_only) {
    constexpr double kMostError = 2;  // voxels, as of gcode2vdb
    if (!(mesh_error >= 0 && mesh_error <= kMostError))
        throw UsageError(
            fmt::format("mesh(): mesh_error={:g}: expected a number from 0 to {:g}, voxels", mesh_error, kMostError));
    exporter::MeshOptions options;
    options.outside_only = outside_only;
    options.error = mesh_error;
    for (std::size_t n = 1; n < self.grids.size(); ++n) {
        const openvdb::GridBase& grid = *self.grids[n];
        if (grid.getName() == "color" && grid.isType<openvdb::Vec3SGrid>())
            options.color = &static_cast<const openvdb::Vec3SGrid&>(grid);
        if (grid.getName() == "tool" && grid.isType<openvdb::Int32Grid>())
            options.tool = &static_cast<const openvdb::Int32Grid&>(grid);
    }
    exporter::SurfaceMesh mesh;
    std::vector<std::uint32_t> corners;
    std::vector<float> vertices;
    runLong(py::none(), [&](const Report&) {
        mesh = exporter::meshSurface(self.surface(), options);
        corners.reserve(3 * mesh.triangleCount());
        mesh.forEachTriangle([&corners](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            corners.insert(corners.end(), {a, b, c});
        });
        vertices.reserve(3 * mesh.points.size());
        for (const openvdb::Vec3s& point : mesh.points) vertices.insert(vertices.end(), {point[0], point[1], point[2]});
    });
    const auto points = static_cast<py::ssize_t>(mesh.points.size());
    const auto triangles = static_cast<py::ssize_t>(corners.size() / 3);
    return namedTuple("Mesh", arrayOf(std::move(vertices), {points, 3}), arrayOf(std::move(corners), {triangles, 3}),
                      colorsOf(mesh));
}

}  // namespace stratum::python
