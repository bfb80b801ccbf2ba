#include "python/arrays.h"
#include "python/errors.h"
#include "python/long_call.h"
#include "python/make_toolpath.h"
#include "python/options/keywords.h"
#include "python/options/path.h"
#include "python/options/signature.h"
#include "python/toolpath_object.h"
#include "python/toolpath_state.h"

#include "base/checksum.h"
#include "base/error.h"
#include "base/human_text.h"
#include "gcode/container/container.h"
#include "gcode/summary.h"
#include "gcode/toolpath/warning_log.h"
#include "voxelize/beads/selection.h"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <typeinfo>
#include <utility>
#include <vector>

namespace stratum::python {

namespace py = pybind11;
using namespace py::literals;

namespace {

constexpr const char* kRead =
    R"(Reads one G-code program: a path, or bytes; plain text or any container (gzip, .bgcode, .gcode.3mf, .ufp, .gx).

timed: plan the motion of the machine, for Toolpath.timing and Toolpath.times; takes about twice as long.
travels: keep the moves that lay nothing, for Toolpath.travels; not with belt, flow_lag and sag.
progress: called with the fraction done, 0..1.
Returns a Toolpath. The options are those of the tools: plate, filament_diameter (mm, one or by tool), filament_colors (one or
by tool, as --color), tool_offsets ("0x0,18x0", mm), layer_height (mm), belt (degrees), planar, e_mode, firmware,
planner, printer, beads, section, flow (per cent), flow_lag (s), pressure_advance (s), sag, crown, strings.

Raises InputError for what is no G-code, UsageError for options out of range.)";

constexpr const char* kMake =
    R"(A toolpath of arrays: beads (bead_dtype, mm, in print order), the runs they refer to (run_dtype), arcs (arc_dtype), and
names of objects, of which the first is "". The arrays are copied.

Raises UsageError, with the index and the remedy, for records that nothing can be made of.)";

ToolpathObject readProgram(const py::object& source, const py::object& progress, const py::kwargs& given) {
    Keywords options("read", given);
    const bool timed = options.flag("timed").value_or(false);
    const bool with_travels = options.flag("travels").value_or(false);
    voxelize::PrintOptions print;
    assemble::readReading(options, print);
    gcode::ReadOptions& read = print.read;
    if (!timed && read.corner_rule != gcode::CornerRule::automatic)
        throw UsageError("read(): planner: times are planned with timed=True alone; give both");
    options.finish();
    std::string bytes;
    std::string path;
    const bool in_memory = py::isinstance<py::bytes>(source) || py::isinstance<py::bytearray>(source);
    if (py::isinstance<py::bytes>(source))
        bytes = source.cast<std::string>();
    else if (in_memory)
        bytes = std::string(PyByteArray_AsString(source.ptr()), py::len(source));
    else if (isPath(source))
        path = pathOf(source);
    else
        throw py::type_error("read(): source: expected a path, or the bytes of a program");
    return callLong(progress, [&](const Report& report) {
        read.progress = report;
        const auto make = [&](std::string_view program, const std::string& name) {
            std::vector<motion::Travel> travels;
            deposit::PrintRead print =
                deposit::readPrint(program, name, read, timed, with_travels ? &travels : nullptr);
            ToolpathObject object{std::make_shared<const gcode::Toolpath>(std::move(print.toolpath)),
                                  std::move(print.times), nullptr,
                                  in_memory ? "" : std::filesystem::path(name).filename(), sha256Hex(program)};
            if (with_travels) object.travels = std::make_shared<const std::vector<motion::Travel>>(std::move(travels));
            return object;
        };
        if (in_memory) return make(bytes, "bytes");
        const gcode::InputBytes file(path);
        return make(file.bytes(), file.name());
    });
}

// Takes what is given, and keeps the rest.
void takeArrays(gcode::Toolpath& toolpath, const py::object& beads, const py::object& runs, const py::object& arcs,
                const py::object& objects) {
    if (!beads.is_none()) toolpath.beads = recordsOf<gcode::Bead>(beads, "beads", "bead_dtype");
    if (!runs.is_none()) toolpath.runs = recordsOf<gcode::Run>(runs, "runs", "run_dtype");
    if (!arcs.is_none()) toolpath.arcs = recordsOf<gcode::Arc>(arcs, "arcs", "arc_dtype");
    if (!objects.is_none()) toolpath.objects = textsOf("make_toolpath", "objects", objects);
}

ToolpathObject finished(gcode::Toolpath&& toolpath, const gcode::Toolpath* before = nullptr) {
    const py::gil_scoped_release release;
    requireValid(toolpath);
    sumUp(toolpath, before);
    return {std::make_shared<const gcode::Toolpath>(std::move(toolpath)), {}, nullptr, "", ""};
}

ToolpathObject makeToolpath(const py::object& beads, const py::object& runs, const py::object& arcs,
                            const py::object& objects, double filament_diameter, double layer_height) {
    gcode::Toolpath toolpath;
    takeArrays(toolpath, beads, runs, arcs, objects);
    if (!(filament_diameter >= 0.1 && filament_diameter <= 20))
        throw UsageError(fmt::format("filament_diameter={:g}: expected 0.1 to 20 mm", filament_diameter));
    if (!(layer_height >= 0 && layer_height <= 50))
        throw UsageError(fmt::format("layer_height={:g}: expected 0 to 50 mm; 0 is unknown", layer_height));
    toolpath.filament_diameter = filament_diameter;
    toolpath.layer_height = layer_height;
    return finished(std::move(toolpath));
}

ToolpathObject replaced(const ToolpathObject& self, const py::object& beads, const py::object& runs,
                        const py::object& arcs, const py::object& objects) {
    gcode::Toolpath toolpath = *self.toolpath;
    const std::size_t count = toolpath.beads.size();
    takeArrays(toolpath, beads, runs, arcs, objects);
    // Times and flow are those of the program, not of what was made of it.
    toolpath.timing.clear();
    toolpath.flow.clear();
    if (toolpath.beads.size() != count) toolpath.color_changes.clear();
    return finished(std::move(toolpath), self.toolpath.get());
}

// A value for each bead.
template <typename Value, typename Of>
py::array perBead(const ToolpathObject& self, const Of& of) {
    const gcode::Toolpath& toolpath = *self.toolpath;
    std::vector<Value> values(toolpath.beads.size());
    {
        const py::gil_scoped_release release;
        for (std::size_t n = 0; n < values.size(); ++n) values[n] = of(toolpath, toolpath.beads[n]);
    }
    const auto count = static_cast<py::ssize_t>(values.size());
    return arrayOf(std::move(values), {count});
}

py::dict statedOf(const gcode::Toolpath& toolpath) {
    const gcode::StatedFacts& facts = toolpath.stated;
    py::dict stated;
    stated["seconds"] = py::cast(facts.seconds);
    stated["model_seconds"] = py::cast(facts.model_seconds);
    stated["grams"] = py::cast(facts.grams);
    stated["cost"] = py::cast(facts.cost);
    stated["materials"] = py::cast(facts.materials);
    stated["nozzle_diameters"] = py::cast(facts.nozzle_diameters);
    stated["printer"] = py::cast(facts.printer);
    stated["layer_height"] = py::cast(facts.layer_height);
    stated["first_layer_height"] = py::cast(facts.first_layer_height);
    return stated;
}

py::object timesOf(const ToolpathObject& self) {
    if (!self.times) return py::none();
    py::dict features;
    for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
        if (self.times->features[f] > 0)
            features[py::str(std::string(gcode::featureName(static_cast<gcode::Feature>(f))))] =
                self.times->features[f];
    return py::dict("total"_a = self.times->total, "travel"_a = self.times->travel,
                    "retraction"_a = self.times->retraction, "waiting"_a = self.times->waiting, "features"_a = features,
                    "layers"_a = self.times->layers, "rule"_a = self.times->rule);
}

py::array selectBeads(const ToolpathObject& self, const py::kwargs& given) {
    Keywords options("select", given);
    voxelize::PrintOptions print;
    assemble::readSelection(options, print);
    options.finish();
    std::vector<std::uint32_t> selection =
        voxelize::selectBeads(*self.toolpath, voxelize::selectionOf(print, *self.toolpath));
    const auto count = static_cast<py::ssize_t>(selection.size());
    return arrayOf(std::move(selection), {count});
}

py::list warningsOf(const gcode::Toolpath& toolpath) {
    py::list warnings;
    for (const gcode::Warning& warning : toolpath.warnings)
        warnings.append(py::dict("text"_a = inPython(warning.text), "first_line"_a = warning.first_line,
                                 "count"_a = warning.count));
    return warnings;
}

void addArrays(py::class_<ToolpathObject>& type) {
    // What an array is made of; null: nobody asked for it.
    const auto array = [&type](const char* name, auto records, const char* doc) {
        type.def_property_readonly(
            name,
            [records](const py::object& self) -> py::object {
                const auto* const given = records(self.cast<const ToolpathObject&>());
                return given != nullptr ? viewOf(*given, self) : py::object(py::none());
            },
            doc);
    };
    const auto unlessEmpty = [](const auto& records) { return records.empty() ? nullptr : &records; };
    array(
        "timing", [=](const ToolpathObject& self) { return unlessEmpty(self.toolpath->timing); },
        "Read-only array of timing_dtype by bead, without a copy: s since the program's begin, s, mm/s. None "
        "unless read with timed=True or flow_lag.");
    array(
        "flow", [=](const ToolpathObject& self) { return unlessEmpty(self.toolpath->flow); },
        "Read-only array of flow_dtype by bead, without a copy: mm^3, mm^3/s, mm. None unless read with flow_lag.");
    array(
        "travels", [](const ToolpathObject& self) { return self.travels ? &*self.travels : nullptr; },
        "Read-only array of travel_dtype, without a copy, in order: the moves of the nozzle that lay nothing. mm, "
        "mm/s; filament is what E moves meanwhile (negative: drawn back); bead is the index of the next bead; "
        "start and seconds are 0 unless timed=True. None unless read with travels=True.");
    array(
        "beads", [](const ToolpathObject& self) { return &self.toolpath->beads; },
        "Read-only array of bead_dtype, without a copy, in print order: mm; z is that of the nozzle, the top of "
        "the bead; run is an index into runs; arc is an index into arcs, or minus the line if straight.");
    array(
        "runs", [](const ToolpathObject& self) { return &self.toolpath->runs; },
        "Read-only array of run_dtype, without a copy: what consecutive beads share. height mm, speed mm/s.");
    array(
        "arcs", [](const ToolpathObject& self) { return &self.toolpath->arcs; },
        "Read-only array of arc_dtype, without a copy: center mm, sweep radians.");
    using Path = gcode::Toolpath;
    using gcode::Bead;
    const auto each = [&type](const std::string& name, auto of, const char* doc) {
        using Value = decltype(of(Path(), Bead()));
        type.def(
            name.c_str(), [of](const ToolpathObject& self) { return perBead<Value>(self, of); },
            documented(name + "(self)", doc).c_str());
    };
    each(
        "bead_layers", [](const Path& t, const Bead& b) { return t.runOf(b).layer; },
        "The layer of each bead: 1, 2, ...; 0 is what comes before the first.");
    each(
        "bead_features", [](const Path& t, const Bead& b) { return static_cast<std::uint8_t>(t.runOf(b).feature); },
        "The feature of each bead, an index into stratum.features.");
    each(
        "bead_tools", [](const Path& t, const Bead& b) { return t.runOf(b).tool; }, "The T number of each bead.");
    each(
        "bead_objects", [](const Path& t, const Bead& b) { return t.runOf(b).object; },
        "The object of each bead, an index into objects; 0 is none.");
    each(
        "bead_lines", [](const Path& t, const Bead& b) { return t.lineOf(b); },
        "The line of each bead in its file, from 1.");
    each(
        "bead_lengths", [](const Path& t, const Bead& b) { return gcode::beadLength(t, b); },
        "The length of each bead's path, mm, its climb included.");
    each(
        "bead_volumes",
        [](const Path& t, const Bead& b) {
            return gcode::laidVolume(t, static_cast<std::uint32_t>(&b - t.beads.data()));
        },
        "What each bead lays, mm^3.");
}

void addFacts(py::class_<ToolpathObject>& type) {
    const auto fact = [&type](const char* name, auto member, const char* doc) {
        type.def_property_readonly(
            name, [member](const ToolpathObject& self) { return (*self.toolpath).*member; }, doc);
    };
    fact("objects", &gcode::Toolpath::objects, "Names of the labelled objects; [0] is \"\".");
    fact("slicer", &gcode::Toolpath::slicer, "e.g. \"PrusaSlicer 2.5.0\"; empty if the file doesn't say.");
    fact("firmware", &gcode::Toolpath::firmware, "The rule set used, e.g. \"marlin\".");
    fact("format", &gcode::Toolpath::format, "The container, e.g. \"ascii\", \"bgcode\".");
    fact("filament_diameter", &gcode::Toolpath::filament_diameter, "mm, of tool 0.");
    fact("layer_height", &gcode::Toolpath::layer_height, "mm, nominal, from the file's settings; 0 if unknown.");
    fact("layer_count", &gcode::Toolpath::layer_count, "Number of the last layer.");
    fact("belt_angle", &gcode::Toolpath::belt_angle,
         "Degrees: turned by it about x, the beads lie as in the world; 0 but on a belt.");
    fact("extrusion_rule", &gcode::Toolpath::extrusion_rule, "Unit of E and its source.");
    fact("cut_short", &gcode::Toolpath::cut_short, "Why the program seems truncated; empty if it doesn't.");
    fact("filament_mm", &gcode::Toolpath::filament_mm, "mm of filament in the beads.");
    fact("prime_mm", &gcode::Toolpath::prime_mm, "The part of it that prime lines before layer 1 take.");
    fact("primed_mm", &gcode::Toolpath::primed_mm,
         "Pushed out in place between lines beyond what was drawn back, in no bead.");
    fact("extruded_mm3", &gcode::Toolpath::extruded_mm3, "mm^3 that the file extrudes into the beads.");
    type.def_property_readonly(
            "warnings", [](const ToolpathObject& self) { return warningsOf(*self.toolpath); },
            "What is doubtful in the file: dicts of text, first_line, count.")
        .def_property_readonly(
            "stated", [](const ToolpathObject& self) { return statedOf(*self.toolpath); },
            "What the file states of its print: seconds, grams, materials, ...; None where it doesn't.")
        .def_property_readonly("times", &timesOf,
                               "Planned seconds: total, travel, retraction, waiting, features, layers, rule. None "
                               "unless read with timed=True or flow_lag.")
        .def_readonly("source", &ToolpathObject::source, "Name of its file without folders; empty if it has none.")
        .def(
            "summary", [](const ToolpathObject& self) { return inPython(gcode::summarize(*self.toolpath)); },
            documented("summary(self)", "What the file holds, in lines of text.").c_str())
        .def("__getstate__",
             [](const ToolpathObject& self) {
                 std::string state;
                 {
                     const py::gil_scoped_release release;
                     state = stateOf(self);
                 }
                 return py::bytes(state);
             })
        .def("__len__", [](const ToolpathObject& self) { return self.toolpath->beads.size(); })
        .def("__repr__", [](const ToolpathObject& self) {
            return fmt::format("<stratum.Toolpath: {} in {}>", counted(self.toolpath->beads.size(), "bead"),
                               counted(self.toolpath->layer_count, "layer"));
        });
}

// pickle makes an empty one first, and then sets its state. Not by py::pickle(), whose objects have no value until
// then.
void addState(py::class_<ToolpathObject>& type) {
    const auto make = [make_room = py::object(type.attr("__new__"))](const py::object& of) {
        py::object object = make_room(of);
        auto* const instance = reinterpret_cast<py::detail::instance*>(object.ptr());
        auto value = instance->get_value_and_holder(py::detail::get_type_info(typeid(ToolpathObject)));
        value.value_ptr() = new ToolpathObject{.toolpath = std::make_shared<const gcode::Toolpath>()};
        value.type->init_instance(instance, nullptr);
        return object;
    };
    type.attr("__new__") = py::staticmethod(py::cpp_function(make));
    const auto set = [](ToolpathObject& self, const py::bytes& state) {
        if (!self.toolpath->empty() || !self.source.empty())
            throw py::type_error("__setstate__(): a Toolpath never changes");
        const auto bytes = static_cast<std::string_view>(state);
        ToolpathObject read;
        {
            const py::gil_scoped_release release;
            read = toolpathOf(bytes);
        }
        self = std::move(read);
    };
    type.attr("__setstate__") = py::cpp_function(set, py::is_method(type));
}

}  // namespace

void bindToolpath(py::module_& module) {
    py::class_<ToolpathObject> type(module, "Toolpath",
                                    "Everything that one G-code file deposits, in print order: mm, z up. It never "
                                    "changes; replace() makes another.");
    addArrays(type);
    addFacts(type);
    addState(type);
    voxelize::PrintOptions print;
    const std::string selection = parametersOf([&](Keywords& options) { assemble::readSelection(options, print); });
    type.def("select", &selectBeads,
             documented(fmt::format("select(self, *, {})", selection),
                        "Array of indices into beads, ascending; as the tools' options of those names.")
                 .c_str())
        .def("replace", &replaced,
             documented("replace(self, *, beads=None, runs=None, arcs=None, objects=None)",
                        "Another toolpath with these arrays instead; they are checked and copied.")
                 .c_str(),
             py::kw_only(), "beads"_a = py::none(), "runs"_a = py::none(), "arcs"_a = py::none(),
             "objects"_a = py::none());
    module.def(
        "read",
        [](const py::object& source, const py::object& progress, const py::kwargs& options) {
            return readProgram(source, progress, options);
        },
        documented(fmt::format("read(source, *, timed=None, travels=None, progress=None, {})", readingParameters()),
                   kRead)
            .c_str(),
        "source"_a, py::kw_only(), "progress"_a = py::none());
    module.def("make_toolpath", &makeToolpath,
               documented("make_toolpath(beads, runs, arcs=None, objects=None, *, filament_diameter=1.75, "
                          "layer_height=0.0)",
                          kMake)
                   .c_str(),
               "beads"_a, "runs"_a, "arcs"_a = py::none(), "objects"_a = py::none(), py::kw_only(),
               "filament_diameter"_a = 1.75, "layer_height"_a = 0.0);
    module.attr("bead_dtype") = recordType<gcode::Bead>();
    module.attr("run_dtype") = recordType<gcode::Run>();
    module.attr("arc_dtype") = recordType<gcode::Arc>();
    module.attr("timing_dtype") = recordType<gcode::BeadTiming>();
    module.attr("travel_dtype") = recordType<motion::Travel>();
    module.attr("flow_dtype") = recordType<gcode::BeadFlow>();
    py::list features;
    for (std::size_t f = 0; f < gcode::kFeatureCount; ++f)
        features.append(std::string(gcode::featureName(static_cast<gcode::Feature>(f))));
    module.attr("features") = py::tuple(features);
}

}  // namespace stratum::python
