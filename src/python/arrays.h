// NumPy arrays of the libraries' records, without a copy, and arrays of points.
#pragma once

#include "gcode/toolpath/toolpath.h"
#include "motion/travels.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <vector>

namespace stratum::python {

/// The structured type of a record, with the record's own offsets and size. Needs the GIL.
template <typename Record>
pybind11::dtype recordType();
template <>
pybind11::dtype recordType<gcode::Bead>();
template <>
pybind11::dtype recordType<gcode::Run>();
template <>
pybind11::dtype recordType<gcode::Arc>();
template <>
pybind11::dtype recordType<gcode::BeadTiming>();
template <>
pybind11::dtype recordType<gcode::BeadFlow>();
template <>
pybind11::dtype recordType<motion::Travel>();

/// A read-only array over memory that `owner` keeps alive.
pybind11::array viewOf(const pybind11::dtype& type, const std::vector<pybind11::ssize_t>& shape, const void* data,
                       const pybind11::object& owner);
template <typename Record>
pybind11::array viewOf(const std::vector<Record>& records, const pybind11::object& owner) {
    return viewOf(recordType<Record>(), {static_cast<pybind11::ssize_t>(records.size())}, records.data(), owner);
}

/// An array that takes over a vector.
template <typename Value>
pybind11::array_t<Value> arrayOf(std::vector<Value>&& values, std::vector<pybind11::ssize_t> shape) {
    auto* kept = new std::vector<Value>(std::move(values));
    const pybind11::capsule owner(kept, [](void* vector) { delete static_cast<std::vector<Value>*>(vector); });
    return pybind11::array_t<Value>(std::move(shape), kept->data(), owner);
}

/// Of an attribute that counts: -1 where there is no value, and the nearest that fits for what is too large.
inline std::int32_t integerOf(float value) {
    constexpr float kMost = 2147483520.0F;  // the largest float that fits
    return std::isnan(value) ? -1 : static_cast<std::int32_t>(std::clamp(value, -kMost, kMost));
}

/// A copy of records of that type. Throws UsageError, with the remedy, for another shape or type
/// and for masked values.
/// @param name  of the argument, for messages
/// @param type_name  of the type in this module
template <typename Record>
std::vector<Record> recordsOf(const pybind11::handle& array, std::string_view name, std::string_view type_name);
extern template std::vector<gcode::Bead> recordsOf(const pybind11::handle&, std::string_view, std::string_view);
extern template std::vector<gcode::Run> recordsOf(const pybind11::handle&, std::string_view, std::string_view);
extern template std::vector<gcode::Arc> recordsOf(const pybind11::handle&, std::string_view, std::string_view);

/// A copy of an array of shape (N, 3) of finite numbers: of another thread's writing nothing is seen. Throws
/// UsageError, also for masked values.
std::vector<glm::dvec3> pointsOf(const pybind11::handle& array, std::string_view name);

}  // namespace stratum::python
