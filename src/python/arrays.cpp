#include "python/arrays.h"

#include "base/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>

namespace stratum::python {

namespace py = pybind11;

namespace {

struct Field {
    const char* name;
    std::string type;
    std::size_t offset;
};

// With NumPy's letter and bytes of the number.
template <typename Number>
Field fieldOf(const char* name, std::size_t offset) {
    constexpr bool kReal = std::is_floating_point_v<Number> || std::is_same_v<Number, gcode::PackedDouble>;
    constexpr const char* kLetter = kReal ? "f" : std::is_signed_v<Number> ? "i" : "u";
    return {name, fmt::format("{}{}{}", sizeof(Number) > 1 ? "<" : "", kLetter, sizeof(Number)), offset};
}

#define FIELD(name) fieldOf<decltype(Record::name)>(#name, offsetof(Record, name))

template <typename Record>
py::dtype typeOf(std::initializer_list<Field> fields) {
    py::list names;
    py::list formats;
    py::list offsets;
    for (const Field& field : fields) {
        names.append(field.name);
        formats.append(field.type);
        offsets.append(field.offset);
    }
    return {names, formats, offsets, static_cast<py::ssize_t>(sizeof(Record))};
}

std::string shapeOf(const py::array& array) {
    const std::vector<py::ssize_t> shape(array.shape(), array.shape() + array.ndim());
    return fmt::format("({}{})", fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
}

// Under a mask there is a placeholder, which would be read as data. Records have a mask a field.
void refuseMasked(const py::handle& array, std::string_view name) {
    if (!py::hasattr(array, "mask") || !py::isinstance(array, py::module_::import("numpy.ma").attr("MaskedArray")))
        return;
    const auto mask = py::module_::import("numpy").attr("ascontiguousarray")(array.attr("mask"));
    if (mask.attr("view")("bool").attr("any")().cast<bool>())
        throw UsageError(
            fmt::format("{}: has masked values; leave out what they belong to, e.g. by numpy.ma.compress_rows(), or "
                        "give them values by .filled()",
                        name));
}

}  // namespace

template <>
py::dtype recordType<gcode::Bead>() {
    using Record = gcode::Bead;
    return typeOf<Record>(
        {FIELD(x0), FIELD(y0), FIELD(z0), FIELD(x1), FIELD(y1), FIELD(z1), FIELD(width), FIELD(run), FIELD(arc)});
}

template <>
py::dtype recordType<gcode::Run>() {
    using Record = gcode::Run;
    return typeOf<Record>({FIELD(height), FIELD(speed), FIELD(layer), FIELD(object), FIELD(tool), FIELD(feature)});
}

template <>
py::dtype recordType<gcode::Arc>() {
    using Record = gcode::Arc;
    return typeOf<Record>({FIELD(center_x), FIELD(center_y), FIELD(sweep), FIELD(line)});
}

template <>
py::dtype recordType<gcode::BeadTiming>() {
    using Record = gcode::BeadTiming;
    return typeOf<Record>({FIELD(start), FIELD(seconds), FIELD(entry), FIELD(peak), FIELD(exit)});
}

template <>
py::dtype recordType<gcode::BeadFlow>() {
    using Record = gcode::BeadFlow;
    return typeOf<Record>({FIELD(volume), FIELD(rate), FIELD(widening)});
}

template <>
py::dtype recordType<motion::Travel>() {
    using Record = motion::Travel;
    return typeOf<Record>({FIELD(x0), FIELD(y0), FIELD(z0), FIELD(x1), FIELD(y1), FIELD(z1), FIELD(center_x),
                           FIELD(center_y), FIELD(start), FIELD(sweep), FIELD(seconds), FIELD(speed), FIELD(filament),
                           FIELD(bead), FIELD(line)});
}

py::array viewOf(const py::dtype& type, const std::vector<py::ssize_t>& shape, const void* data,
                 const py::object& owner) {
    // Of nothing, too, the owner owns it.
    static const char nothing = 0;
    py::array view(type, shape, {}, data != nullptr ? data : &nothing, owner);
    // Others read the same records without the GIL: nobody may write to them.
    view.attr("setflags")(py::arg("write") = false);
    return view;
}

template <typename Record>
std::vector<Record> recordsOf(const py::handle& array, std::string_view name, std::string_view type_name) {
    const py::dtype type = recordType<Record>();
    if (!py::isinstance<py::array>(array))
        throw UsageError(fmt::format("{}: expected a NumPy array of {}; make one with numpy.zeros(n, stratum.{})", name,
                                     type_name, type_name));
    refuseMasked(array, name);
    const auto given = py::reinterpret_borrow<py::array>(array);
    if (given.ndim() != 1)
        throw UsageError(
            fmt::format("{}: expected one dimension, not the shape {}; use .reshape(-1)", name, shapeOf(given)));
    if (!given.dtype().equal(type))
        throw UsageError(fmt::format(
            "{}: expected the dtype stratum.{}, not {}; make numpy.zeros(n, stratum.{}) and copy field by field", name,
            type_name, py::str(given.dtype()).cast<std::string>(), type_name));
    const auto dense = py::array::ensure(given, py::array::c_style);
    std::vector<Record> records(static_cast<std::size_t>(dense.size()));
    if (!records.empty())
        std::memcpy(static_cast<void*>(records.data()), dense.data(), records.size() * sizeof(Record));
    return records;
}

template std::vector<gcode::Bead> recordsOf(const py::handle&, std::string_view, std::string_view);
template std::vector<gcode::Run> recordsOf(const py::handle&, std::string_view, std::string_view);
template std::vector<gcode::Arc> recordsOf(const py::handle&, std::string_view, std::string_view);

std::vector<glm::dvec3> pointsOf(const py::handle& array, std::string_view name) {
    refuseMasked(array, name);
    const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
    if (!numbers) {
        PyErr_Clear();
        throw UsageError(fmt::format("{}: expected numbers in an array of shape (N, 3)", name));
    }
    if (numbers.ndim() != 2 || numbers.shape(1) != 3)
        throw UsageError(
            fmt::format("{}: expected the shape (N, 3), not {}; use .reshape(-1, 3)", name, shapeOf(numbers)));
    std::vector<glm::dvec3> points(static_cast<std::size_t>(numbers.shape(0)));
    static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
    if (!points.empty())
        std::memcpy(static_cast<void*>(points.data()), numbers.data(), points.size() * sizeof(glm::dvec3));
    for (std::size_t n = 0; n < points.size(); ++n)
        if (!std::isfinite(points[n].x) || !std::isfinite(points[n].y) || !std::isfinite(points[n].z))
            throw UsageError(
                fmt::format("{}[{}]: is not finite; leave such rows out, e.g. "
                            "a[numpy.isfinite(a).all(axis=1)]",
                            name, n));
    return points;
}

}  // namespace stratum::python
