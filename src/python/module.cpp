// The Python module stratum._stratum: the package stratum takes everything from it.
#include "python/bindings.h"
#include "python/errors.h"
#include "python/level_set_object.h"
#include "python/threads.h"
#include "python/toolpath_object.h"

#include "base/atomic_file.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <pybind11/pybind11.h>

#include <string>

namespace {

namespace py = pybind11;

std::string nameOf(const py::handle& type) { return type.attr("__name__").cast<std::string>(); }

// Of a class of the module itself. Python gives those without constructors a slot of that name.
bool hasInit(const py::handle& type) {
    const py::object own = type.attr("__dict__");
    return own.contains("__init__") && PyInstanceMethod_Check(own["__init__"].ptr());
}

// Of objects without a value, as X.__new__(X) and copying make them, pybind11 would read memory that nobody has
// written. Refuses them for all classes of the module but those that give them one.
void refuseBareObjects(const py::module_& module) {
    for (const auto& [name, type] : module.attr("__dict__").cast<py::dict>()) {
        if (PyType_Check(type.ptr()) == 0) continue;
        if (py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(type.ptr())) == nullptr)
            continue;  // an exception
        const py::object own = type.attr("__dict__");
        if (own.contains("__new__")) continue;
        py::cpp_function make;
        if (hasInit(type))
            make = [make_room = py::object(type.attr("__new__")), init = py::object(type.attr("__init__"))](
                       const py::object& of, const py::args& values, const py::kwargs& named) {
                // A class of a user's with an __init__ of its own calls this one, with values of its own.
                if (!py::object(of.attr("__init__")).is(init)) return make_room(of);
                if (values.empty() && named.empty()) throw py::type_error(nameOf(of) + "(): expected arguments");
                py::object made = make_room(of);
                init(made, *values, **named);  // of an object with a value pybind11 ignores the call that comes next
                return made;
            };
        else
            make = [](const py::object& of, const py::args&, const py::kwargs&) -> py::object {
                throw py::type_error(
                    fmt::format("{}: No constructor defined! Functions of stratum make such objects.", nameOf(of)));
            };
        type.attr("__new__") = py::staticmethod(make);
    }
}

}  // namespace

PYBIND11_MODULE(_stratum, module) {
    using namespace stratum::python;
    // Docstrings begin with signatures of their own: documented().
    pybind11::options docstrings;
    docstrings.disable_function_signatures();
    module.attr("__version__") = STRATUM_VERSION;
    openvdb::initialize();
    stratum::Replacement::guard(true);
    bindErrors(module);
    bindToolpath(module);
    bindLevelSet(module);
    bindMeasures(module);
    bindPrintField(module);
    bindIntersector(module);
    bindPicture(module);
    bindThreads(module);
    refuseBareObjects(module);
}
