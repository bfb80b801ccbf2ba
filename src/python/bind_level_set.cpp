#include "assemble/print/read_print_options.h"
#include "python/arrays.h"
#include "python/conversion.h"
#include "python/dense_block.h"
#include "python/level_set_mesh.h"
#include "python/level_set_object.h"
#include "python/named_tuple.h"
#include "python/options/path.h"
#include "python/options/signature.h"
#include "python/point_loop.h"

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "march/file/level_set_file.h"

#include <fmt/format.h>
#include <openvdb/tools/Dense.h>
#include <openvdb/tools/Interpolation.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stratum::python {

namespace py = pybind11;
using namespace py::literals;
using Kind = trace::AttributeSummary::Kind;

namespace {

constexpr const char* kVoxelize =
    R"(The level set of a print in memory, with the grids of its attributes. Options as those of gcode2vdb: voxel_size (mm),
voxels_per_layer, tolerance (mm), memory_budget ("4GB"), half_width (voxels); layers, features, objects, tools;
interior ("keep", "cull"), interior_distance, grids (names), unit ("mm", "cm", "m"), up ("z", "y"), origin ("bed",
"center", "min").

Raises UsageError for options that don't fit the print or the memory.)";

constexpr const char* kBlock =
    R"(A Block: the samples of a print in one dense float32 array, values[x, y, z], mm: negative inside, the background (half_width
voxels) far outside. origin is the place of values[0, 0, 0], mm. box: two corners, mm; None is all that is selected.
Only what the box meets is made, and no sparse grid. Options: voxel_size (mm), voxels_per_layer, tolerance (mm),
memory_budget, half_width (voxels); layers, features, objects, tools.)";

constexpr const char* kWrite =
    R"(Writes the file that gcode2vdb writes with these options, leaf by leaf while they are made if nothing needs the grid.
Options of voxelize(), and precision ("float", "half"), compression ("blosc", "zip", "none"), overwrite (False): whether
a file that this program did not write may be replaced; else UsageError.

Raises OutputError; an old file of that name then stays.)";

using Matrix = py::array_t<double>;

constexpr std::size_t kPlanes = 8;  // of a dense block, that one thread copies at a time

constexpr std::array<std::pair<std::string_view, exporter::Compression>, 3> kCompressions = {
    {{"blosc", exporter::Compression::blosc},
     {"zip", exporter::Compression::zip},
     {"none", exporter::Compression::none}}};
constexpr std::array<std::pair<std::string_view, bool>, 2> kPrecisions = {{{"float", false}, {"half", true}}};

exporter::FileOptions fileOptionsOf(Keywords& options) {
    exporter::FileOptions file;
    assign(file.half, options.choice("precision", kPrecisions));
    assign(file.compression, options.choice("compression", kCompressions));
    return file;
}

std::string fileParameters() {
    return parametersOf([](Keywords& options) { (void)fileOptionsOf(options); }) + ", overwrite=None";
}

// The tools write other formats by other endings; this is the one here.
std::string vdbPathOf(const py::object& path) {
    std::string to = pathOf(path);
    if (!to.ends_with(".vdb")) throw UsageError(fmt::format("{}: the name must end in .vdb", to));
    return to;
}

// Two corners, in any order.
voxelize::Bounds boxOf(const py::object& box) {
    const std::vector<glm::dvec3> corners = pointsOf(box, "box");
    if (corners.size() != 2) throw UsageError("box: expected two corners, ((x0, y0, z0), (x1, y1, z1))");
    voxelize::Bounds bounds;
    for (int axis = 0; axis < 3; ++axis) {
        bounds.min[axis] = std::min(corners[0][axis], corners[1][axis]);
        bounds.max[axis] = std::max(corners[0][axis], corners[1][axis]);
    }
    return bounds;
}

py::array_t<float> emptyBlock(const openvdb::CoordBBox& box) {
    requireFits(box);
    const openvdb::Coord size = box.dim();
    return py::array_t<float>(std::vector<py::ssize_t>{size[0], size[1], size[2]});
}

py::tuple vectorOf(const openvdb::Vec3d& v) { return py::make_tuple(v[0], v[1], v[2]); }

LevelSetObject voxelizePrint(const ToolpathObject& print, const py::object& progress, const py::kwargs& given) {
    Keywords keywords("voxelize", given);
    exporter::LevelSetChoices choices = levelSetChoicesOf(keywords);
    keywords.finish();
    return callLong(progress, [&](const Report& report) {
        return LevelSetObject{makeGrids(print, exporter::LevelSetPlan(*print.toolpath, std::move(choices)), report)};
    });
}

py::object voxelizeBlock(const ToolpathObject& print, const py::object& box, const py::object& progress,
                         const py::kwargs& given) {
    Keywords keywords("voxelize_block", given);
    exporter::LevelSetChoices choices;
    assemble::readConversion(keywords, choices.print);
    choices.attributes.emplace();
    keywords.finish();
    if (print.toolpath->belt_angle != 0)
        throw UsageError(
            "voxelize_block: the samples of a print on a belt lean with its layers, and a block has no transform; "
            "take voxelize(), whose level set has one");
    const bool all = box.is_none();
    const voxelize::Bounds wanted = all ? voxelize::Bounds() : boxOf(box);
    const exporter::LevelSetPlan plan = callLong(
        py::none(), [&](const Report&) { return exporter::LevelSetPlan(*print.toolpath, std::move(choices)); });
    const voxelize::Lattice& lattice = plan.lattice();
    const openvdb::CoordBBox samples = all ? samplesAround(plan.bounds(), lattice) : samplesIn(wanted, lattice);
    py::array_t<float> values = emptyBlock(samples);
    float* const to = values.mutable_data();
    runLong(progress,
            [&](const Report& report) { fillDense(print.toolpath, plan.selection(), lattice, samples, to, report); });
    const openvdb::Vec3d origin = samples.min().asVec3d() * lattice.voxel_size + openvdb::Vec3d(0, 0, lattice.origin_z);
    return namedTuple("Block", values, vectorOf(origin), lattice.voxel_size);
}

void writeVdb(const ToolpathObject& print, const py::object& path, const py::object& progress,
              const py::kwargs& given) {
    Keywords keywords("write_vdb", given);
    exporter::LevelSetChoices choices = levelSetChoicesOf(keywords);
    const exporter::FileOptions file = fileOptionsOf(keywords);
    const bool overwrite = keywords.flag("overwrite").value_or(false);
    keywords.finish();
    const std::string to = vdbPathOf(path);
    const Replacement may(to, overwrite);
    runLong(progress, [&](const Report& report) {
        writePrint(print, exporter::LevelSetPlan(*print.toolpath, std::move(choices)), to, file, report);
    });
}

LevelSetObject readLevelSet(const py::object& path, const std::string& grid,
                            const std::vector<std::string>& attributes) {
    const std::string from = pathOf(path);
    return callLong(py::none(), [&](const Report&) {
        LevelSetObject result;
        result.grids.push_back(march::readLevelSet(from, grid));
        for (const std::string& name : attributes)
            result.grids.push_back(
                openvdb::ConstPtrCast<openvdb::GridBase>(march::readAttributeGrid(from, name, result.surface())));
        return result;
    });
}

void writeLevelSet(const LevelSetObject& self, const py::object& path, const py::kwargs& given) {
    Keywords keywords("LevelSet.write", given);
    const exporter::FileOptions file = fileOptionsOf(keywords);
    const bool overwrite = keywords.flag("overwrite").value_or(false);
    keywords.finish();
    const std::string to = vdbPathOf(path);
    const Replacement may(to, overwrite);
    // The writer notes the precision in the grids: in copies that share the trees.
    openvdb::GridPtrVec grids;
    for (const openvdb::GridBase::Ptr& grid : self.grids) grids.push_back(grid->copyGrid());
    for (std::size_t n = 0; n < grids.size(); ++n) grids[n]->setTransform(self.grids[n]->transformPtr());
    runLong(py::none(), [&](const Report&) { exporter::writeVdb(grids, to, file); });
}

// The samples whose world-space places lie in a box; for turned grids, those of the box around it.
openvdb::CoordBBox samplesOf(const LevelSetObject& self, const py::object& box) {
    const openvdb::FloatGrid& grid = self.surface();
    if (box.is_none()) return grid.evalActiveVoxelBoundingBox();
    const voxelize::Bounds bounds = boxOf(box);
    const openvdb::BBoxd index =
        grid.transform().worldToIndex(openvdb::BBoxd(openvdb::Vec3d(bounds.min), openvdb::Vec3d(bounds.max)));
    voxelize::Bounds samples;
    for (int axis = 0; axis < 3; ++axis) {
        samples.min[axis] = index.min()[axis];
        samples.max[axis] = index.max()[axis];
    }
    voxelize::Lattice unit;
    unit.voxel_size = 1;
    return samplesIn(samples, unit);
}

py::object denseOf(const LevelSetObject& self, const py::object& box) {
    const openvdb::FloatGrid& grid = self.surface();
    const openvdb::CoordBBox samples = samplesOf(self, box);
    py::array_t<float> values = emptyBlock(samples);
    float* const to = values.mutable_data();
    const auto plane = static_cast<std::size_t>(samples.dim()[1]) * static_cast<std::size_t>(samples.dim()[2]);
    const auto planes = static_cast<std::size_t>(samples.dim()[0]);
    // A few planes of constant x at a time, which are one run of memory.
    runLong(py::none(), [&](const Report&) {
        parallelFor(planes, kPlanes, [&](std::size_t first, std::size_t last) {
            openvdb::CoordBBox part = samples;
            part.min()[0] = samples.min()[0] + static_cast<int>(first);
            part.max()[0] = samples.min()[0] + static_cast<int>(last) - 1;
            openvdb::tools::Dense<float, openvdb::tools::LayoutZYX> dense(part, to + first * plane);
            openvdb::tools::copyToDense(grid, dense, true);
        });
    });
    return namedTuple("Block", values, vectorOf(grid.transform().indexToWorld(samples.min())), grid.voxelSize()[0]);
}

py::array_t<float> sample(const LevelSetObject& self, const py::object& array, const py::object& progress) {
    const std::vector<glm::dvec3> points = pointsOf(array, "points");
    std::vector<float> values(points.size());
    const openvdb::FloatGrid& grid = self.surface();
    forPoints(points.size(), progress, [&](std::size_t first, std::size_t last) {
        const auto accessor = grid.getConstAccessor();
        const openvdb::math::MapBase::ConstPtr map = grid.transform().baseMap();
        for (std::size_t n = first; n < last; ++n) {
            const openvdb::Vec3d index = map->applyInverseMap({points[n].x, points[n].y, points[n].z});
            constexpr double kMost = 1e9;  // of whole numbers
            values[n] = std::abs(index[0]) < kMost && std::abs(index[1]) < kMost && std::abs(index[2]) < kMost
                            ? openvdb::tools::BoxSampler::sample(accessor, index)
                            : grid.background();
        }
    });
    const auto count = static_cast<py::ssize_t>(values.size());
    return arrayOf(std::move(values), {count});
}

py::array attributeAt(const LevelSetObject& self, const std::string& name, const py::object& points) {
    const openvdb::GridBase::ConstPtr grid = self.attribute(name);
    return lookUp(*march::makeAttributeSource(grid), kindOf(*grid), points);
}

Matrix transformOf(const LevelSetObject& self) {
    const openvdb::Mat4d linear = self.surface().transform().baseMap()->getAffineMap()->getMat4();
    std::vector<double> columns;
    // OpenVDB multiplies from the left: the transpose is what others use.
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 4; ++column) columns.push_back(linear(column, row));
    return arrayOf(std::move(columns), {4, 4});
}

py::dict metadataOf(const LevelSetObject& self) {
    py::dict metadata;
    for (auto meta = self.surface().beginMeta(); meta != self.surface().endMeta(); ++meta) {
        const openvdb::Metadata& value = *meta->second;
        py::object shown = py::str(value.str());
        if (value.typeName() == "double")
            shown = py::float_(static_cast<const openvdb::DoubleMetadata&>(value).value());
        if (value.typeName() == "vec3d") shown = vectorOf(static_cast<const openvdb::Vec3DMetadata&>(value).value());
        metadata[py::str(meta->first)] = shown;
    }
    return metadata;
}

}  // namespace

openvdb::GridBase::ConstPtr LevelSetObject::attribute(const std::string& name) const {
    std::string names;
    for (std::size_t n = 1; n < grids.size(); ++n) {
        if (grids[n]->getName() == name) return grids[n];
        names += (names.empty() ? "" : ", ") + grids[n]->getName();
    }
    throw UsageError(fmt::format("the level set has no attribute {}; {}", name,
                                 names.empty() ? "give grids to voxelize(), or attributes to LevelSet.read()"
                                               : fmt::format("there are {}", names)));
}

Kind kindOf(const openvdb::GridBase& grid) {
    if (grid.isType<openvdb::Int32Grid>()) return Kind::integer;
    return grid.isType<openvdb::Vec3SGrid>() ? Kind::color : Kind::number;
}

py::array lookUp(const march::AttributeSource& source, Kind kind, const py::object& array) {
    const std::vector<glm::dvec3> points = pointsOf(array, "points");
    const std::size_t channels = kind == Kind::color ? 3 : 1;
    std::vector<float> values(points.size() * channels, std::numeric_limits<float>::quiet_NaN());
    forPoints(points.size(), py::none(), [&](std::size_t first, std::size_t last) {
        const std::unique_ptr<march::AttributeLookup> lookup = source.makeLookup();
        for (std::size_t n = first; n < last; ++n)
            if (const auto value = lookup->at(points[n]))
                for (std::size_t c = 0; c < channels; ++c)
                    values[n * channels + c] = (*value)[static_cast<glm::length_t>(c)];
    });
    const auto count = static_cast<py::ssize_t>(points.size());
    if (kind == Kind::color) return arrayOf(std::move(values), {count, 3});
    if (kind == Kind::number) return arrayOf(std::move(values), {count});
    std::vector<std::int32_t> integers(values.size());
    for (std::size_t n = 0; n < values.size(); ++n) integers[n] = integerOf(values[n]);
    return arrayOf(std::move(integers), {count});
}

namespace {

void addMethods(py::class_<LevelSetObject>& type) {
    type.def_static("read", &readLevelSet,
                    documented("read(path, grid='', attributes=())",
                               "The level set of a .vdb; grid '' is \"surface\", or the only level set.")
                        .c_str(),
                    "path"_a, "grid"_a = "", "attributes"_a = std::vector<std::string>())
        .def("write", &writeLevelSet,
             documented(fmt::format("write(self, path, *, {})", fileParameters()),
                        "A .vdb of all grids: precision 'float' (default) or 'half', compression 'blosc' (default), "
                        "'zip' or 'none'. overwrite: files that this program did not write are replaced, too. Raises "
                        "OutputError.")
                 .c_str(),
             "path"_a)
        .def("dense", &denseOf,
             documented("dense(self, box=None)",
                        "A Block: the samples in a box (two corners, world space), or all that are active, as float32 "
                        "values[x, y, z] along the axes of the grid; origin is the place of values[0, 0, 0].")
                 .c_str(),
             "box"_a = py::none())
        .def("mesh", &meshOf,
             documented("mesh(self, *, mesh_error=0.25, outside_only=False)",
                        "A Mesh: the surface as triangles, closed, counter-clockwise from outside, in world space. "
                        "mesh_error: how far faces may be merged, voxels; 0 keeps all. outside_only: without the "
                        "surfaces of cavities. colors are there if the level set has the grid color.")
                 .c_str(),
             py::kw_only(), "mesh_error"_a = 0.25, "outside_only"_a = false)
        .def("sample", &sample,
             documented("sample(self, points, *, progress=None)",
                        "float32 (N,): the distance at points (N, 3) of world space, trilinear between samples, world "
                        "units; the background far outside, minus it deep inside.")
                 .c_str(),
             "points"_a, py::kw_only(), "progress"_a = py::none())
        .def("attribute", &attributeAt,
             documented("attribute(self, name, points)",
                        "Of the nearest active voxel around each point: int32 (N,) with -1 where there "
                        "is none, float32 (N,) with NaN, or linear colors float32 (N, 3) with NaN.")
                 .c_str(),
             "name"_a, "points"_a);
}

void addFacts(py::class_<LevelSetObject>& type) {
    type.def_property_readonly(
            "attributes",
            [](const LevelSetObject& self) {
                std::vector<std::string> names;
                for (std::size_t n = 1; n < self.grids.size(); ++n) names.push_back(self.grids[n]->getName());
                return names;
            },
            "Names of the attribute grids.")
        .def_property_readonly(
            "voxel_size", [](const LevelSetObject& self) { return self.surface().voxelSize()[0]; },
            "World units; the first edge of a voxel that is no cube.")
        .def_property_readonly(
            "background", [](const LevelSetObject& self) { return self.surface().background(); }, "World units.")
        .def_property_readonly(
            "active_voxels", [](const LevelSetObject& self) { return self.surface().activeVoxelCount(); },
            "Samples in the narrow band.")
        .def_property_readonly(
            "bytes",
            [](const LevelSetObject& self) {
                std::size_t bytes = 0;
                for (const openvdb::GridBase::Ptr& grid : self.grids) bytes += grid->memUsage();
                return bytes;
            },
            "Memory of all grids.")
        .def_property_readonly(
            "bounds",
            [](const LevelSetObject& self) {
                const trace::Box box = march::narrowBandBounds(self.surface());
                return py::make_tuple(py::make_tuple(box.min.x, box.min.y, box.min.z),
                                      py::make_tuple(box.max.x, box.max.y, box.max.z));
            },
            "Two corners of the narrow band, world space.")
        .def_property_readonly("transform", &transformOf,
                               "4 x 4: world = transform @ (i, j, k, 1), of the samples' indices.")
        .def_property_readonly("metadata", &metadataOf, "What a file says of the level set.")
        .def("__repr__", [](const LevelSetObject& self) {
            return fmt::format("<stratum.LevelSet: {} active voxels of {:g}>", self.surface().activeVoxelCount(),
                               self.surface().voxelSize()[0]);
        });
}

}  // namespace

void bindLevelSet(py::module_& module) {
    defineNamedTuple(module, "Block", "values origin voxel_size",
                     "A box of samples: float32 values[x, y, z], the place of values[0, 0, 0], the distance of two.");
    defineNamedTuple(module, "Mesh", "vertices faces colors",
                     "Triangles: vertices float32 (N, 3), faces uint32 (M, 3) of indices, and colors of the vertices, "
                     "uint8 (N, 3), sRGB, or None.");
    py::class_<LevelSetObject> type(module, "LevelSet",
                                    "A sparse level set in memory, and the grids of its attributes. It never changes.");
    addMethods(type);
    addFacts(type);
    const std::string choices = parametersOf([](Keywords& given) { (void)levelSetChoicesOf(given); });
    module.def("voxelize", &voxelizePrint,
               documented(fmt::format("voxelize(toolpath, *, progress=None, {})", choices), kVoxelize).c_str(),
               "toolpath"_a, py::kw_only(), "progress"_a = py::none());
    module.def(
        "voxelize_block", &voxelizeBlock,
        documented(fmt::format("voxelize_block(toolpath, box=None, *, progress=None, {})", conversionParameters()),
                   kBlock)
            .c_str(),
        "toolpath"_a, "box"_a = py::none(), py::kw_only(), "progress"_a = py::none());
    module.def("write_vdb", &writeVdb,
               documented(fmt::format("write_vdb(toolpath, path, *, progress=None, {}, {})", choices, fileParameters()),
                          kWrite)
                   .c_str(),
               "toolpath"_a, "path"_a, py::kw_only(), "progress"_a = py::none());
}

}  // namespace stratum::python
