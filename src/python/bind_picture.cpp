#include "python/bindings.h"

#include "python/arrays.h"
#include "python/long_call.h"
#include "python/options/path.h"
#include "python/options/picture_options.h"
#include "python/options/signature.h"
#include "python/toolpath_object.h"

#include "assemble/file/file_facts.h"
#include "assemble/finished_picture.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "shade/film/picture.h"
#include "shade/post/denoise.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace stratum::python {

namespace py = pybind11;
using namespace py::literals;

namespace {

constexpr const char* kRender =
    R"(A Picture: ray-traces a Toolpath, or the file of that path: G-code in any container, or a .vdb with a level set. Of G-code only the
voxels that rays meet are made. The options are those of vdbtrace, with its defaults: size (width, height), spp, noise,
seconds, seed, crop, aov, denoise, exposure (stops), legend; view, eye, look_at, up, fov (degrees), f_number, aperture,
focus, frame, zoom; integrator, bounces, exact_translucency, phong, ao_distance; brdf, color, color_by, color_range, normals; env,
env_rotation (degrees), env_exposure (stops), lights, bed, bed_surface, background; march, brick_values, brick_cache,
clip (nx, ny, nz, d), grid, file_up; of G-code those of read() and voxelize(), voxel_size "auto", and printed.

Raises InputError for files that can't be traced, UsageError for options that don't fit.)";

/// A finished picture. Never changes.
struct PictureObject {
    shade::Film film;
    shade::ToneOptions tone;
    shade::Metadata metadata;
    std::optional<shade::Legend> legend;
    shade::RayCounts rays;
    double mean_spp = 0;
    double fov = 0;  // degrees, of the camera
    glm::dvec3 eye{0.0}, forward{0.0}, up{0.0};
};

// The picture that vdbtrace makes.
PictureObject makePicture(const std::string& path, RenderCall& call, const Report& report) {
    assemble::PictureRequest& options = call;
    const bool denoised = assemble::chooseDenoising(call.denoising(), options.render);
    options.tracing.events.fraction = report;
    options.tracing.events.begin = [&report](std::string_view, bool) { report(0); };
    const std::vector<assemble::ObjectOptions> objects{{.vdb = path, .grid = call.grid, .up = call.file_up}};
    const assemble::ReadyScene ready = assemble::readyScene(objects, options);
    const auto progress = [&report](std::uint64_t done, std::uint64_t all) {
        report(static_cast<double>(done) / static_cast<double>(all));
    };
    shade::RenderResult result = shade::render(*ready.objects.intersector, ready.scene, options.render, progress);
    if (denoised) {
        shade::denoise(result.film, progress);
        const auto& crop = options.render.crop;
        if (crop && result.film.region() != *crop) result.film = result.film.part(*crop);
    }
    PictureObject picture;
    picture.tone = ready.tone;
    if (call.exposure) picture.tone.exposure = *call.exposure;
    picture.tone.validate();
    picture.metadata = assemble::metadataOf(std::filesystem::path(path).filename().string(), options.render,
                                            options.scene.env, ready.objects, ready.scene, result, denoised);
    if (result.film.content() == shade::FilmContent::radiance)
        picture.metadata.insert(assemble::exposureFact(picture.tone));
    if (call.legend && !ready.objects.legends.empty()) picture.legend = ready.objects.legends.front();
    picture.rays = result.rays;
    picture.mean_spp = result.mean_spp;
    const shade::Camera& camera = ready.scene.camera;
    picture.fov = camera.fov();
    picture.eye = camera.eye();
    picture.forward = camera.forward();
    picture.up = camera.up();
    picture.film = std::move(result.film);
    return picture;
}

// Options without an effect on that source are refused, as vdbtrace does.
void refuse(const std::vector<std::string>& given, const std::string& why) {
    if (!given.empty()) throw UsageError(fmt::format("render(): {}: {}", fmt::join(given, ", "), why));
}

std::unique_ptr<PictureObject> render(const py::object& source, const py::object& progress, const py::kwargs& given) {
    Keywords keywords("render", given);
    RenderCall call = renderCallOf(keywords);
    keywords.finish();
    std::string path;
    if (!call.tool_colors.empty()) call.tracing.prints.print.read.filament_colors = call.tool_colors;
    if (py::isinstance<ToolpathObject>(source)) {
        if (!call.tool_colors.empty())
            throw UsageError("render(): color: of a Toolpath that is read already, read() takes filament_colors");
        refuse(call.of_reading, "of G-code that is read here; of a Toolpath, read() takes them");
        const auto& print = source.cast<const ToolpathObject&>();
        call.tracing.prints.toolpath = print.toolpath;
        path = print.source.empty() ? "print" : print.source;
    } else if (isPath(source)) {
        path = pathOf(source);
        if (assemble::isVdbFile(path)) {
            const std::string why = path + " is a level set, whose voxels are made; give the G-code, or leave them out";
            refuse(call.of_prints, why);
            refuse(call.of_reading, why);
        }
    } else {
        throw py::type_error(
            "render(): source: expected a Toolpath or a path; write a LevelSet to a .vdb first, LevelSet.write(path)");
    }
    return callLong(progress, [&](const Report& report) {
        return std::make_unique<PictureObject>(makePicture(path, call, report));
    });
}

const PictureObject& pictureOf(const py::object& self) { return self.cast<const PictureObject&>(); }

std::vector<py::ssize_t> shapeOf(const shade::Film& film, py::ssize_t channels) {
    return {film.height(), film.width(), channels};
}

// Of each pixel's four floats the first three, or the last, without a copy.
py::array channelsOf(const py::object& self, std::size_t first, py::ssize_t count) {
    const shade::Film& film = pictureOf(self).film;
    static_assert(sizeof(shade::Pixel) == 4 * sizeof(float));
    const py::array all = viewOf(py::dtype::of<float>(), shapeOf(film, 4), film.pixels().data(), self);
    const auto begin = static_cast<py::ssize_t>(first);
    if (count == 1) return all[py::make_tuple(py::ellipsis(), begin)].cast<py::array>();
    return all[py::make_tuple(py::ellipsis(), py::slice(begin, begin + count, 1))].cast<py::array>();
}

py::array displayOf(const PictureObject& self) {
    std::vector<std::uint8_t> pixels;
    const bool alpha = self.film.transparent();
    {
        const py::gil_scoped_release release;
        pixels = alpha ? shade::toDisplayWithAlpha(self.film, self.tone) : shade::toDisplay(self.film, self.tone);
        if (self.legend && !alpha) shade::draw(*self.legend, self.film.width(), self.film.height(), pixels);
    }
    return arrayOf(std::move(pixels), shapeOf(self.film, alpha ? 4 : 3));
}

py::dict layersOf(const py::object& self) {
    const shade::Film& film = pictureOf(self).film;
    py::dict layers;
    for (const shade::FilmLayer& layer : film.layers()) {
        const auto channels = static_cast<py::ssize_t>(layer.channels.size());
        py::array values = viewOf(py::dtype::of<float>(), shapeOf(film, channels), layer.values.data(), self);
        layers[py::str(layer.name)] = channels == 1 ? values[py::make_tuple(py::ellipsis(), 0)] : py::object(values);
    }
    return layers;
}

void writePicture(const PictureObject& self, const py::object& path, bool overwrite) {
    const std::string to = pathOf(path);
    const Replacement may(to, overwrite);
    runLong(py::none(), [&](const Report&) {
        shade::PictureFile file(to);
        shade::Metadata metadata = self.metadata;
        if (file.linear()) metadata.erase(assemble::exposureFact(self.tone).first);
        file.write(self.film, metadata, self.tone, self.legend && !file.linear() ? &*self.legend : nullptr);
    });
}

py::tuple tupleOf(const glm::dvec3& v) { return py::make_tuple(v.x, v.y, v.z); }

}  // namespace

void bindPicture(py::module_& module) {
    py::class_<PictureObject>(module, "Picture", "A finished picture. It never changes.")
        .def_property_readonly(
            "linear", [](const py::object& self) { return channelsOf(self, 0, 3); },
            "Read-only float32 (height, width, 3), without a copy: linear RGB, premultiplied by alpha.")
        .def_property_readonly(
            "alpha", [](const py::object& self) { return channelsOf(self, 3, 1); },
            "Read-only float32 (height, width), without a copy: 0 where nothing is.")
        .def_property_readonly(
            "srgb", &displayOf,
            "uint8 (height, width, 3): tone-mapped sRGB, the pixels of vdbtrace's .png; with background "
            "'none' (height, width, 4), colors not multiplied by alpha.")
        .def_property_readonly("layers", &layersOf,
                               "Of aov, and of the denoiser: read-only float32 (height, width) or (height, width, "
                               "channels), without a copy, by name.")
        .def_property_readonly(
            "exposure", [](const PictureObject& self) { return self.tone.exposure; }, "Stops, of srgb.")
        .def_property_readonly(
            "metadata", [](const PictureObject& self) { return self.metadata; }, "The facts that its file states.")
        .def_property_readonly(
            "rays", [](const PictureObject& self) { return self.rays.total(); }, "Rays that were traced.")
        .def_property_readonly(
            "samples_per_pixel", [](const PictureObject& self) { return self.mean_spp; }, "Mean.")
        .def_property_readonly(
            "camera",
            [](const PictureObject& self) {
                return py::dict("eye"_a = tupleOf(self.eye), "forward"_a = tupleOf(self.forward),
                                "up"_a = tupleOf(self.up), "fov"_a = self.fov);
            },
            "World space: eye; unit forward and up; fov, vertical, degrees.")
        .def("write", &writePicture,
             documented("write(self, path, *, overwrite=False)",
                        ".png, .jpg or .webp as srgb, or a linear .exr with its layers. overwrite: a file that this "
                        "program did not write is replaced, too. Raises OutputError.")
                 .c_str(),
             "path"_a, py::kw_only(), "overwrite"_a = false)
        .def("__repr__", [](const PictureObject& self) {
            return fmt::format("<stratum.Picture: {} x {}>", self.film.width(), self.film.height());
        });
    module.def("render", &render,
               documented(fmt::format("render(source, *, progress=None, {})",
                                      parametersOf([](Keywords& given) { (void)renderCallOf(given); })),
                          kRender)
                   .c_str(),
               "source"_a, py::kw_only(), "progress"_a = py::none());
}

}  // namespace stratum::python
