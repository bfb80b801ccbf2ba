#include "python/errors.h"

#include "base/error.h"

#include <array>
#include <cctype>
#include <exception>
#include <string_view>
#include <utility>

namespace stratum::python {

namespace py = pybind11;

namespace {

// Those that Python calls otherwise than by '_' for '-'.
constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kOtherNames = {{{"tool", "tools"},
                                                                                       {"object", "objects"},
                                                                                       {"light", "lights"},
                                                                                       {"time", "seconds"},
                                                                                       {"color", "filament_colors"},
                                                                                       {"compare-at", "at"},
                                                                                       {"force", "overwrite=True"}}};

bool isOf(char c) { return std::islower(static_cast<unsigned char>(c)) != 0 || c == '-'; }

// Behind the name of a tool and before an option: a command line, which stays one.
bool endsWithTool(std::string_view text) {
    for (const std::string_view tool : {"gcode2vdb ", "vdbtrace ", "vdbview "})
        if (text.ends_with(tool)) return true;
    return false;
}

}  // namespace

std::string inPython(std::string_view text) {
    std::string told;
    for (std::size_t n = 0; n < text.size();) {
        const bool begins = n == 0 || std::string_view(" (,;:").find(text[n - 1]) != std::string_view::npos;
        if (!begins || !text.substr(n).starts_with("--") || n + 2 == text.size() || text[n + 2] == '-' ||
            !isOf(text[n + 2]) || endsWithTool(text.substr(0, n))) {
            told += text[n++];
            continue;
        }
        std::size_t end = n + 2;
        while (end < text.size() && isOf(text[end])) ++end;
        std::string name(text.substr(n + 2, end - n - 2));
        for (const auto& [option, other] : kOtherNames)
            if (name == option) name = other;
        for (char& c : name)
            if (c == '-') c = '_';
        told += name;
        n = end;
    }
    return told;
}

void bindErrors(py::module_& module) {
    static const py::exception<InputError> input(module, "InputError", PyExc_RuntimeError);
    static const py::exception<UsageError> usage(module, "UsageError", PyExc_ValueError);
    static const py::exception<OutputError> output(module, "OutputError", PyExc_OSError);
    input.attr("__doc__") =
        "Input that can't be used: missing, empty, of another kind, out of range. The text says where and what to do.";
    usage.attr("__doc__") = "An option, an array, or a combination of them that makes no sense for this input.";
    output.attr("__doc__") = "An output that could not be written. An old file of that name is untouched.";
    // Names of files and of objects may be no UTF-8.
    static const auto raise = [](const py::handle& type, const char* what) {
        const std::string text = inPython(what);
        const auto told = py::reinterpret_steal<py::object>(
            PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
        PyErr_SetObject(type.ptr(), told.ptr());
    };
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(std::move(thrown));
        } catch (const InputError& error) {
            raise(input, error.what());
        } catch (const UsageError& error) {
            raise(usage, error.what());
        } catch (const OutputError& error) {
            raise(output, error.what());
        }
    });
}

}  // namespace stratum::python
