#include "python/options/keywords.h"

#include "python/options/path.h"

#include "base/error.h"
#include "base/names.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace stratum::python {

namespace py = pybind11;

namespace {

bool isNumber(const py::handle& value) {
    return PyNumber_Check(value.ptr()) != 0 && PyBool_Check(value.ptr()) == 0 && !py::isinstance<py::array>(value) &&
           PyComplex_Check(value.ptr()) == 0;
}

}  // namespace

std::optional<py::object> Keywords::find(std::string_view name) {
    if (std::find(known_.begin(), known_.end(), name) == known_.end()) known_.emplace_back(name);
    if (!given(name)) return std::nullopt;
    py::object value = (*given_)[py::str(name.data(), name.size())];
    if (std::find(found_.begin(), found_.end(), name) == found_.end()) found_.emplace_back(name);
    return value;
}

void Keywords::fail(std::string_view name, std::string_view expected) const {
    const py::str key(name.data(), name.size());
    throw py::type_error(
        fmt::format("{}: expected {}, not {}", called(name), expected, py::repr((*given_)[key]).cast<std::string>()));
}

double Keywords::finite(std::string_view name, const py::handle& value) const {
    if (!isNumber(value)) fail(name, "a number");
    const double number = PyFloat_AsDouble(value.ptr());
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (!std::isfinite(number))
        throw UsageError(fmt::format("{}(): {}: expected a finite number, not {}", function_, name, number));
    return number;
}

bool Keywords::given(std::string_view name) const {
    const py::str key(name.data(), name.size());
    return given_->contains(key) && !(*given_)[key].is_none();
}

std::optional<double> Keywords::number(std::string_view name) {
    const std::optional<py::object> value = find(name);
    if (!value) return std::nullopt;
    return finite(name, *value);
}

std::optional<std::int64_t> Keywords::integer(std::string_view name, std::int64_t least, std::int64_t most) {
    const std::optional<py::object> given = find(name);
    if (!given) return std::nullopt;
    if (PyIndex_Check(given->ptr()) == 0 || PyBool_Check(given->ptr()) != 0) fail(name, "a whole number");
    int overflow = 0;
    const py::object index = py::reinterpret_steal<py::object>(PyNumber_Index(given->ptr()));
    if (!index) throw py::error_already_set();
    const long long value = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    if (overflow != 0 || value < least || value > most)
        throw UsageError(fmt::format("{}(): {}={}: expected a whole number from {} to {}", function_, name,
                                     py::str(*given).cast<std::string>(), least, most));
    return value;
}

std::optional<bool> Keywords::flag(std::string_view name) {
    const std::optional<py::object> value = find(name);
    if (!value) return std::nullopt;
    if (PyBool_Check(value->ptr()) == 0) fail(name, "True or False");
    return value->cast<bool>();
}

std::optional<std::string> Keywords::text(std::string_view name) {
    const std::optional<py::object> value = find(name);
    if (!value) return std::nullopt;
    if (!isPath(*value)) fail(name, "a text");
    return pathOf(*value);
}

std::vector<double> Keywords::list(std::string_view name, char /*separator*/) {
    const std::optional<py::object> value = find(name);
    if (!value) return {};
    if (isNumber(*value)) return {finite(name, *value)};
    if (!py::isinstance<py::sequence>(*value) || isPath(*value)) fail(name, "a number or a list of them");
    std::vector<double> numbers;
    for (const py::handle& item : *value) numbers.push_back(finite(name, item));
    return numbers;
}

std::vector<std::string> textsOf(const std::string& function, const char* name, const py::object& value) {
    py::kwargs given;
    given[name] = value;
    return Keywords(function, given).texts(name);
}

std::vector<std::string> Keywords::texts(std::string_view name) {
    const std::optional<py::object> value = find(name);
    if (!value) return {};
    if (isPath(*value)) return {pathOf(*value)};
    if (!py::isinstance<py::sequence>(*value)) fail(name, "a text or a list of them");
    std::vector<std::string> texts;
    for (const py::handle& item : *value) {
        if (!isPath(item)) fail(name, "a text or a list of them");
        texts.push_back(pathOf(item));
    }
    return texts;
}

bool Keywords::says(std::string_view name, std::string_view word) {
    const std::optional<py::object> value = find(name);
    return value && py::isinstance<py::str>(*value) && value->cast<std::string>() == word;
}

std::string Keywords::called(std::string_view name) const { return fmt::format("{}(): {}", function_, name); }

void Keywords::refuse(std::string_view name, std::string_view expected) const {
    const py::str key(name.data(), name.size());
    throw UsageError(
        fmt::format("{}={}: expected {}", called(name), py::repr((*given_)[key]).cast<std::string>(), expected));
}

void Keywords::finish() const {
    for (const auto& item : *given_) {
        const auto name = item.first.cast<std::string>();
        if (std::find(known_.begin(), known_.end(), name) != known_.end()) continue;
        const std::vector<std::string_view> names(known_.begin(), known_.end());
        throw py::type_error(fmt::format("{}(): no option is named {}{}; there are {}", function_, name,
                                         didYouMean(name, names), fmt::join(names, ", ")));
    }
}

}  // namespace stratum::python
