#include "python/bare_objects.h"

namespace py = pybind11;

namespace stratum::python {
namespace {

// pybind11's own, for all classes: room for a value, without one.
newfunc makeRoom = nullptr;

PyObject* refuse(PyTypeObject* type, PyObject*, PyObject*) {
    PyErr_Format(PyExc_TypeError, "%s: No constructor defined! Functions of stratum make such objects.", type->tp_name);
    return nullptr;
}

// With arguments, __init__ comes next.
PyObject* refuseBare(PyTypeObject* type, PyObject* values, PyObject* named) {
    const bool given = PyTuple_GET_SIZE(values) > 0 || (named != nullptr && PyDict_GET_SIZE(named) > 0);
    if (given) return makeRoom(type, values, named);
    PyErr_Format(PyExc_TypeError, "%s: expected arguments", type->tp_name);
    return nullptr;
}

PyObject* makeEmpty(PyTypeObject* type, PyObject* values, PyObject* named) {
    PyObject* const object = makeRoom(type, values, named);
    if (object == nullptr) return nullptr;
    PyObject* const none = PyObject_CallMethod(object, kBeginEmpty, nullptr);
    if (none == nullptr) {
        Py_DECREF(object);
        return nullptr;
    }
    Py_DECREF(none);
    return object;
}

}  // namespace

void refuseBareObjects(py::module_& module) {
    for (const auto& [name, value] : module.attr("__dict__").cast<py::dict>()) {
        if (PyType_Check(value.ptr()) == 0) continue;
        auto* const type = reinterpret_cast<PyTypeObject*>(value.ptr());
        if (py::detail::get_type_info(type) == nullptr) continue;  // an exception
        makeRoom = type->tp_new;
        const auto own = [type](const char* method) { return PyDict_GetItemString(type->tp_dict, method) != nullptr; };
        type->tp_new = own(kBeginEmpty) ? makeEmpty : own("__init__") ? refuseBare : refuse;
        PyType_Modified(type);
    }
}

}  // namespace stratum::python
