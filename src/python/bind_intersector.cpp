#include "assemble/print/read_print_options.h"
#include "python/arrays.h"
#include "python/conversion.h"
#include "python/level_set_object.h"
#include "python/named_tuple.h"
#include "python/options/path.h"
#include "python/options/signature.h"
#include "python/point_loop.h"

#include "base/error.h"
#include "march/attribute/annotation.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "ondemand/print_attributes.h"

#include <fmt/format.h>
#include <pybind11/stl.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace stratum::python {

namespace py = pybind11;
using namespace py::literals;
using Kind = trace::AttributeSummary::Kind;

namespace {

Kind valueKind(voxelize::Attribute attribute) {
    switch (voxelize::attributeKind(attribute)) {
        case voxelize::AttributeKind::integer:
            return Kind::integer;
        case voxelize::AttributeKind::number:
            return Kind::number;
        default:
            return Kind::color;
    }
}

PrintFieldObject makeField(const ToolpathObject& print, const py::kwargs& given) {
    Keywords keywords("PrintField", given);
    exporter::LevelSetChoices choices;
    assemble::readConversion(keywords, choices.print);
    choices.attributes.emplace();
    keywords.finish();
    return callLong(py::none(), [&](const Report&) {
        const exporter::LevelSetPlan plan(*print.toolpath, std::move(choices));
        return PrintFieldObject{std::make_shared<const ondemand::PrintField>(
            print.toolpath, plan.selection(), plan.lattice(), plan.placement(),
            print.source.empty() ? "print" : print.source)};
    });
}

py::array_t<double> distanceOf(const PrintFieldObject& self, const py::object& array, const py::object& progress) {
    const std::vector<glm::dvec3> points = pointsOf(array, "points");
    const ondemand::PointDistance distance(self.field->layout());
    const voxelize::Placement lies = voxelize::placementOf(*self.field->layout().toolpath);
    std::vector<double> values(points.size());
    forPoints(points.size(), progress, [&](std::size_t first, std::size_t last) {
        for (std::size_t n = first; n < last; ++n) {
            const auto [x, y, z] = voxelize::printOf({points[n].x, points[n].y, points[n].z}, lies);
            values[n] = distance.at({x, y, z});
        }
    });
    const auto count = static_cast<py::ssize_t>(values.size());
    return arrayOf(std::move(values), {count});
}

/// What an intersector is made of, before its bricks.
struct Parts {
    std::shared_ptr<const trace::Intersector> shape;
    march::Annotation annotation;
    std::vector<Kind> kinds;
};

Parts partsOf(const PrintFieldObject& print, const std::vector<std::string>& attributes, march::BrickValues values) {
    Parts parts;
    for (const std::string& name : attributes) {
        const voxelize::Attribute attribute = ondemand::attributeNamed(name);
        requireTimes(*print.field->layout().toolpath, {&attribute, 1});
        parts.annotation.attributes.push_back(ondemand::makePrintAttribute(print.field, attribute));
        parts.kinds.push_back(valueKind(attribute));
    }
    parts.annotation.smooth_field = print.field;
    parts.shape = march::makeBrickIntersector(std::shared_ptr<const march::LeafField>(print.field), values);
    return parts;
}

Parts partsOf(const LevelSetObject& level_set, const std::vector<std::string>& attributes, march::BrickValues values) {
    Parts parts;
    for (const std::string& name : attributes) {
        const openvdb::GridBase::ConstPtr grid = level_set.attribute(name);
        parts.annotation.attributes.push_back(march::makeAttributeSource(grid));
        parts.kinds.push_back(kindOf(*grid));
    }
    parts.annotation.smooth = openvdb::GridBase::grid<openvdb::FloatGrid>(level_set.grids.front());
    parts.shape = march::makeBrickIntersector(level_set.surface(), values);
    return parts;
}

// Bricks of large files are read when rays come to them.
Parts partsOf(const std::string& path, const std::string& grid, const std::vector<std::string>& attributes,
              march::BrickValues values, bool smooth) {
    Parts parts;
    std::shared_ptr<const march::LeafFile> file = march::openLevelSet(path, grid);
    openvdb::FloatGrid::ConstPtr whole;
    if (!file || smooth) whole = march::readLevelSet(path, grid);
    for (const std::string& name : attributes) {
        const openvdb::GridBase::ConstPtr attribute =
            march::readAttributeGrid(path, name, file ? file->head() : *whole);
        parts.annotation.attributes.push_back(march::makeAttributeSource(attribute));
        parts.kinds.push_back(kindOf(*attribute));
    }
    parts.annotation.smooth = whole;
    parts.shape =
        file ? march::makeBrickIntersector(std::move(file), values) : march::makeBrickIntersector(*whole, values);
    return parts;
}

constexpr std::array<std::pair<std::string_view, march::BrickValues>, 2> kBrickValues = {
    {{"int16", march::BrickValues::Int16}, {"float", march::BrickValues::Float32}}};

IntersectorObject makeIntersector(const py::object& source, const py::object& names, const py::kwargs& given) {
    Keywords keywords("Intersector", given);
    const bool smooth = keywords.flag("smooth_normals").value_or(false);
    const std::string grid = keywords.text("grid").value_or("");
    const march::BrickValues values = keywords.choice("brick_values", kBrickValues).value_or(march::BrickValues::Int16);
    keywords.finish();
    const std::vector<std::string> attributes = textsOf("Intersector", "attributes", names);
    const bool is_print = py::isinstance<PrintFieldObject>(source);
    const bool is_grid = py::isinstance<LevelSetObject>(source);
    std::string path;
    if (!is_print && !is_grid) {
        if (!isPath(source))
            throw py::type_error("Intersector(): source: expected a PrintField, a LevelSet, or the path of a .vdb");
        path = pathOf(source);
    }
    if (!grid.empty() && (is_print || is_grid)) throw UsageError("Intersector(): grid: of the path of a .vdb alone");
    const auto* print = is_print ? &source.cast<const PrintFieldObject&>() : nullptr;
    const auto* level_set = is_grid ? &source.cast<const LevelSetObject&>() : nullptr;
    IntersectorObject result;
    runLong(py::none(), [&](const Report&) {
        Parts parts = print != nullptr       ? partsOf(*print, attributes, values)
                      : level_set != nullptr ? partsOf(*level_set, attributes, values)
                                             : partsOf(path, grid, attributes, values, smooth);
        if (!smooth) {
            parts.annotation.smooth.reset();
            parts.annotation.smooth_field.reset();
        }
        result.intersector = march::annotate(std::move(parts.shape), std::move(parts.annotation));
        result.kinds = std::move(parts.kinds);
    });
    result.attributes = attributes;
    result.source = source;
    return result;
}

/// Rays as they are given; each is made where it is traced.
class Rays {
public:
    Rays(const py::object& origins, const py::object& directions, double t_min, double t_max)
        : origins_(pointsOf(origins, "origins")),
          directions_(pointsOf(directions, "directions")),
          t_min_(t_min),
          t_max_(t_max) {
        const std::size_t from = origins_.size();
        const std::size_t along = directions_.size();
        if (along != from && along != 1 && from != 1)
            throw UsageError(fmt::format(
                "origins and directions: {} and {} rows; give as many of both, or one of either", from, along));
        if (!(t_min >= 0 && t_max > t_min))
            throw UsageError(fmt::format("t_min={:g}, t_max={:g}: expected 0 <= t_min < t_max", t_min, t_max));
        for (std::size_t n = 0; n < along; ++n)
            if (directions_[n] == glm::dvec3(0))
                throw UsageError(fmt::format("directions[{}]: has no length; leave such rays out", n));
    }

    std::size_t size() const {
        return origins_.empty() || directions_.empty() ? 0 : std::max(origins_.size(), directions_.size());
    }
    std::vector<trace::Ray> part(std::size_t first, std::size_t last) const {
        std::vector<trace::Ray> rays(last - first);
        for (std::size_t n = first; n < last; ++n) {
            const glm::dvec3& along = directions_[directions_.size() == 1 ? 0 : n];
            // By the largest component first: squares of extreme numbers are none.
            const double most = std::max({std::abs(along.x), std::abs(along.y), std::abs(along.z)});
            rays[n - first] = {origins_[origins_.size() == 1 ? 0 : n], glm::normalize(along / most), t_min_, t_max_};
        }
        return rays;
    }

private:
    std::vector<glm::dvec3> origins_, directions_;
    double t_min_, t_max_;
};

/// What hits have, in arrays.
struct HitArrays {
    std::vector<double> t, positions, normals;
    std::vector<std::uint8_t> hit;
    std::vector<std::vector<float>> attributes;  // by number; three channels each
};

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

void store(trace::Tracer& tracer, const trace::Hit& hit, std::size_t n, HitArrays& out) {
    const bool any = hit.t < trace::kInfinity;
    out.t[n] = hit.t;
    out.hit[n] = any ? 1 : 0;
    const glm::dvec3 normal = any ? tracer.shadingNormal(hit) : glm::dvec3(kNone);
    for (glm::length_t axis = 0; axis < 3; ++axis) {
        out.positions[3 * n + static_cast<std::size_t>(axis)] = any ? hit.position[axis] : kNone;
        out.normals[3 * n + static_cast<std::size_t>(axis)] = normal[axis];
    }
    for (std::size_t a = 0; any && a < out.attributes.size(); ++a)
        if (const auto value = tracer.attribute(hit, a))
            for (std::size_t c = 0; c < 3; ++c) out.attributes[a][3 * n + c] = (*value)[static_cast<glm::length_t>(c)];
}

py::array attributeArray(const std::vector<float>& values, Kind kind) {
    const auto count = static_cast<py::ssize_t>(values.size() / 3);
    if (kind == Kind::color) return arrayOf(std::vector<float>(values), {count, 3});
    std::vector<float> numbers(values.size() / 3);
    std::vector<std::int32_t> integers(kind == Kind::integer ? numbers.size() : 0);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
        numbers[n] = values[3 * n];
        if (kind == Kind::integer) integers[n] = integerOf(numbers[n]);
    }
    if (kind == Kind::integer) return arrayOf(std::move(integers), {count});
    return arrayOf(std::move(numbers), {count});
}

py::object traceRays(const IntersectorObject& self, const py::object& origins, const py::object& directions,
                     double t_min, double t_max, const py::object& progress) {
    const Rays rays(origins, directions, t_min, t_max);
    HitArrays out{std::vector<double>(rays.size()),
                  std::vector<double>(3 * rays.size()),
                  std::vector<double>(3 * rays.size()),
                  std::vector<std::uint8_t>(rays.size()),
                  {}};
    out.attributes.assign(self.attributes.size(), std::vector<float>(3 * rays.size(), kNone));
    forPoints(rays.size(), progress, [&](std::size_t first, std::size_t last) {
        const std::unique_ptr<trace::Tracer> tracer = self.intersector->makeTracer();
        std::vector<trace::Hit> hits(last - first);
        tracer->intersectStream(rays.part(first, last), hits);
        for (std::size_t n = first; n < last; ++n) store(*tracer, hits[n - first], n, out);
    });
    const auto count = static_cast<py::ssize_t>(rays.size());
    py::dict attributes;
    for (std::size_t a = 0; a < self.attributes.size(); ++a)
        attributes[py::str(self.attributes[a])] = attributeArray(out.attributes[a], self.kinds[a]);
    return namedTuple(
        "Hits", arrayOf(std::move(out.t), {count}), arrayOf(std::move(out.hit), {count}).attr("view")("bool"),
        arrayOf(std::move(out.positions), {count, 3}), arrayOf(std::move(out.normals), {count, 3}), attributes);
}

py::object occluded(const IntersectorObject& self, const py::object& origins, const py::object& directions,
                    double t_min, double t_max, const py::object& progress) {
    const Rays rays(origins, directions, t_min, t_max);
    std::vector<std::uint8_t> blocked(rays.size());
    forPoints(rays.size(), progress, [&](std::size_t first, std::size_t last) {
        self.intersector->makeTracer()->occludedStream(rays.part(first, last),
                                                       std::span(blocked).subspan(first, last - first));
    });
    const auto count = static_cast<py::ssize_t>(rays.size());
    return arrayOf(std::move(blocked), {count}).attr("view")("bool");
}

}  // namespace

void bindPrintField(py::module_& module) {
    py::class_<PrintFieldObject>(module, "PrintField",
                                 documented(fmt::format("PrintField(toolpath, *, {})", conversionParameters()),
                                            "A print that is evaluated where it is asked, without a grid. voxel_size "
                                            "(mm) is that of rays and attributes.")
                                     .c_str())
        .def(py::init(&makeField),
             documented(fmt::format("__init__(self, toolpath, *, {})", conversionParameters()), "As the class says.")
                 .c_str(),
             "toolpath"_a)
        .def("distance", &distanceOf,
             documented("distance(self, points, *, progress=None)",
                        "float64 (N,): exact signed distance to the beads, mm, at points "
                        "(N, 3) of the world, mm; negative but a bound inside; farther away than reach it is reach.")
                 .c_str(),
             "points"_a, py::kw_only(), "progress"_a = py::none())
        .def(
            "attribute",
            [](const PrintFieldObject& self, const std::string& name, const py::object& points) {
                const voxelize::Attribute attribute = ondemand::attributeNamed(name);
                requireTimes(*self.field->layout().toolpath, {&attribute, 1});
                return lookUp(*ondemand::makePrintAttribute(self.field, attribute), valueKind(attribute), points);
            },
            documented(
                "attribute(self, name, points)",
                "Of the bead nearest to each point's nearest voxel in the band: int32 (N,) with "
                "-1 where there is none, float32 (N,) with NaN, or linear colors float32 (N, 3) with NaN. Names as in "
                "gcode2vdb --grids.")
                .c_str(),
            "name"_a, "points"_a)
        .def_property_readonly(
            "voxel_size", [](const PrintFieldObject& self) { return self.field->layout().lattice.voxel_size; },
            "mm, of rays and attributes.")
        .def_property_readonly(
            "reach",
            [](const PrintFieldObject& self) {
                const voxelize::Lattice& lattice = self.field->layout().lattice;
                return (lattice.half_width - 1) * lattice.voxel_size;
            },
            "mm: the largest distance() told, half_width less one voxel.")
        .def("__repr__", [](const PrintFieldObject& self) {
            return fmt::format("<stratum.PrintField: {} beads, voxel {:g} mm>", self.field->layout().stack.beads.size(),
                               self.field->layout().lattice.voxel_size);
        });
}

void bindIntersector(py::module_& module) {
    constexpr std::string_view kParameters =
        "source, attributes=(), *, smooth_normals=None, brick_values=None, grid=None";
    defineNamedTuple(module, "Hits", "t hit positions normals attributes", "The nearest hits of rays, one a row.");
    py::class_<IntersectorObject>(
        module, "Intersector",
        documented(fmt::format("Intersector({})", kParameters),
                   "Rays through a PrintField, a LevelSet, or the .vdb of that path, of which grid is the name. "
                   "brick_values 'float' keeps all bits of the samples, 'int16' (default) those of a hundredth of a "
                   "voxel.")
            .c_str())
        .def(py::init(&makeIntersector),
             documented(fmt::format("__init__(self, {})", kParameters), "As the class says.").c_str(), "source"_a,
             "attributes"_a = py::tuple())
        .def("trace", &traceRays,
             documented(
                 "trace(self, origins, directions, *, t_min=0.0, t_max=1e999, progress=None)",
                 "Hits: the nearest hit of each ray, "
                 "(N, 3) and (N, 3) of world space, of any length. t is in world "
                 "units along the unit direction, inf where nothing is hit; positions and normals (N, 3) are then NaN; "
                 "attributes is a dict of arrays.")
                 .c_str(),
             "origins"_a, "directions"_a, py::kw_only(), "t_min"_a = 0.0, "t_max"_a = trace::kInfinity,
             "progress"_a = py::none())
        .def("occluded", &occluded,
             documented("occluded(self, origins, directions, *, t_min=0.0, t_max=1e999, progress=None)",
                        "bool (N,): whether each ray hits anything.")
                 .c_str(),
             "origins"_a, "directions"_a, py::kw_only(), "t_min"_a = 0.0, "t_max"_a = trace::kInfinity,
             "progress"_a = py::none())
        .def_property_readonly(
            "bounds",
            [](const IntersectorObject& self) {
                const trace::Box box = self.intersector->bounds();
                return py::make_tuple(py::make_tuple(box.min.x, box.min.y, box.min.z),
                                      py::make_tuple(box.max.x, box.max.y, box.max.z));
            },
            "Two corners of the narrow band, world space.")
        .def_property_readonly(
            "voxel_size", [](const IntersectorObject& self) { return self.intersector->voxelSize(); }, "World units.")
        .def_property_readonly(
            "surface_offset", [](const IntersectorObject& self) { return self.intersector->surfaceOffset(); },
            "World units: how far along the normal a secondary ray must start from a hit.")
        .def_property_readonly(
            "bytes", [](const IntersectorObject& self) { return self.intersector->bytes(); },
            "Memory besides its source.");
}

}  // namespace stratum::python
