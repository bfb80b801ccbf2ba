#include "trace_options.h"
#include "shade/finish/named_brdf.h"

#include "choices.h"
#include "color_options.h"
#include "number_list.h"

#include "assemble/file/file_facts.h"
#include "assemble/file/input_files.h"
#include "assemble/file/scene_file.h"
#include "assemble/print/print_colors.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"
#include "gcode/container/container.h"
#include "shade/palette/color_name.h"
#include "voxelize/grid/attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
#include <optional>
#include <utility>

namespace stratum::tools {

const char* const kTraceExamples = R"(
Examples:
  vdbtrace part.vdb                           part.png in studio light
  vdbtrace part.gcode                         the same without a .vdb
  vdbtrace part.gcode --printed 50% --voxel-size 0.05
  vdbtrace part.gcode --film part.mp4 --nozzle      the print as it grows, 8 s
  vdbtrace part.vdb -o part.png --view front --spp 64
  vdbtrace part.vdb -o part.exr --integrator ao     linear values, for compositing and measuring
  vdbtrace part.vdb --brdf plastic:0.8,0.1,0.05,0.2 --env constant:1,1,1
  vdbtrace part.vdb --eye 120,-200,90 --look-at 0,0,20 --fov 25)";

Brief traceBrief() {
    return {{"IN", "A print, a level set, or a scene (.json)"},
            {"--output", ".png, .jpg, .webp or a linear .exr"},
            {"--size", ""},
            {"--spp", "Samples a pixel (default 8, denoised)"},
            {"--noise", "Samples until the error is this, e.g. 0.05"},
            {"--denoise", "The default of light, but for .exr"},
            {"--view", "iso, front, back, left, right, top, bottom"},
            {"--eye", "Where the camera stands"},
            {"--look-at", "What it looks at (default: the part)"},
            {"--turntable", "N pictures from all around"},
            {"--integrator", "path, direct, phong, ao, normal, depth, ..."},
            {"--color", "'#ff6600', teal, 'Prusament Galaxy Black'"},
            {"--brdf", "plastic:R,G,B,ALPHA, pla-blue, a table, ..."},
            {"--color-by", "tool, feature, layer, speed, width, ..."},
            {"--env", "studio, sky, constant:R,G,B, .hdr or .exr"},
            {"--bed", "A bed under the print (the default)"},
            {"--voxel-size", "Of G-code"},
            {"--printer", "ideal, typical, or your printer's limits"},
            {"--printed", "A part of the print: 50%, layer:40"},
            {"--film", "The print as it grows: .mp4, .webm, .gif"},
            {"--threads", ""},
            {"--stats", "Write a JSON report; - is standard output"},
            {"--quiet", ""},
            {"--version", "How it was built, and with what"},
            {"--help", ""},
            {"--help-all", ""}};
}

namespace {

namespace fs = std::filesystem;

constexpr const char* kOnce = "once";  // --turntable without a number

std::optional<glm::dvec3> parseVector(const std::string& text, const char* option) {
    const std::vector<double> v = parseNumbers(text, {3}, option, "X,Y,Z");
    return glm::dvec3(v[0], v[1], v[2]);
}

constexpr std::size_t kSceneHead = 4096;  // a brace is found there, if the file is a scene

// Of several inputs, one that can't be read is told of when its turn comes.
bool isScene(const fs::path& path, bool alone) {
    if (gcode::isStream(path)) return false;
    try {
        return assemble::isSceneFile(InputFile(path).first(kSceneHead));
    } catch (const InputError&) {
        if (alone) throw;
        return false;
    }
}

constexpr const char* kLight = "Light and material";

void addInputOptions(CLI::App& app, TraceCommand& o) {
    app.add_option(
           "IN", o.inputs,
           "A level set, a print (G-code in any container), or a scene that names some; options override the scene. "
           "Several level sets or prints make a series of pictures with the camera of the last. - is standard input")
        ->required()
        ->type_name("FILE.vdb|FILE.gcode|SCENE.json");
    app.add_option(
           "-o,--output", o.output,
           "A tone-mapped .png, .jpg or .webp, or a linear .exr; - is a PNG on standard output, -.exr an EXR; with "
           "--each a folder")
        ->type_name("FILE|DIR");
    app.add_flag("--each", o.each, "Of several inputs, a picture each with a camera of its own, not a series");
    app.add_option("--grid", o.grid, "Which grid (default: surface, or the only level set)")->type_name("NAME");

    app.add_option("--file-up", o.file_up,
                   "Which axis of the level set points up: z or y (default: what the file says, or z)")
        ->check(oneOf({"z", "y"}))
        ->type_name("AXIS");
}

void addPictureOptions(CLI::App& app, TraceCommand& o) {
    const char* picture = "Picture";
    app.add_option("--size", o.size, "Pixels (default 1280x960)")->type_name("WxH")->group(picture);
    app.add_option("--spp", o.render.spp, "Samples a pixel (default 16; if denoised 8, small pictures more)")
        ->each([&o](const std::string&) { o.spp_given = true; })
        ->type_name("N")
        ->group(picture);
    app.add_option("--noise", o.render.noise,
                   "Samples until the relative error is this, e.g. 0.05, but no more than --spp (then 4096 by default)")
        ->type_name("T")
        ->group(picture);
    app.add_option("--time", o.render.seconds,
                   "Samples until this time is over, the noisiest tiles first; another machine, another picture")
        ->type_name("SECONDS")
        ->group(picture);
    app.add_option("--checkpoint", o.render.checkpoint,
                   "Keeps what is finished in this file and goes on from there; the picture is the same")
        ->type_name("FILE")
        ->group(picture);
    completes(app.add_option("--aov", o.aov,
                             "More layers, for .exr: normal, depth, position, albedo, mask, variance, samples, layer, "
                             "tool, feature"),
              Completion::list,
              {"normal", "depth", "position", "albedo", "mask", "variance", "samples", "layer", "tool", "feature"})
        ->type_name("NAME,...")
        ->group(picture);
    app.add_flag_callback(
           "--denoise", [&o] { o.denoise = true; },
           "Takes noise out of the finished picture, guided by its geometry (the default of pictures of light, but "
           ".exr)")
        ->group(picture);
    app.add_flag_callback(
           "--no-denoise", [&o] { o.denoise = false; }, "The mean of the samples as it is (the default for .exr)")
        ->group(picture);
    app.add_option("--seed", o.render.seed, "Another seed, another noise")->type_name("N")->group(picture);
    app.add_option("--crop", o.crop, "Only these pixels of the same picture")->type_name("X0,Y0,X1,Y1")->group(picture);
    app.add_option("--exposure", o.tone.exposure, "Stops, for pictures to look at (default: found from the light)")
        ->each([&o](const std::string&) { o.exposure_given = true; })
        ->type_name("EV")
        ->group(picture);
}

void addCameraOptions(CLI::App& app, TraceCommand& o) {
    const char* camera = "Camera";
    completes(app.add_option("--view", o.view, "iso, front, back, left, right, top, bottom (default iso)"),
              Completion::word, wordsOf(shade::kViews))
        ->type_name("NAME")
        ->group(camera);
    const auto vector = [&](const char* name, std::string& value, const char* help) {
        return app.add_option(name, value, help)->type_name("X,Y,Z")->group(camera);
    };
    auto* eye = vector("--eye", o.eye, "Where the camera stands, in the world units of the .vdb");
    vector("--look-at", o.look_at, "What it looks at (default: the middle of the part)")->needs(eye);
    vector("--up", o.up, "Which way is up (default 0,0,1)");
    app.add_option("--f-number", o.scene.camera.f_number, "Depth of field of a camera with a picture 24 mm high")
        ->type_name("N")
        ->group(camera);
    app.add_option("--aperture", o.scene.camera.aperture, "The same by the diameter of the lens, in world units")
        ->type_name("LENGTH")
        ->group(camera);
    app.add_option("--focus", o.focus, "Distance that is sharp, or a point (default: the middle of the part)")
        ->type_name("LENGTH|X,Y,Z")
        ->group(camera);
    app.add_option("--turntable", o.turns,
                   "N numbered pictures from all around; of a film: the camera goes round N times (default 1)")
        ->expected(0, 1)
        ->default_str(kOnce)
        ->type_name("[N]")
        ->group(camera);
    app.add_option("--fov", o.scene.camera.fov, "Vertical angle of view (default 28)")->type_name("DEG")->group(camera);
    app.add_option("--frame", o.frame,
                   "What a named view is fitted to: part, without skirts, prime towers and start lines, or all that is "
                   "there (default part)")
        ->check(CLI::IsMember({"part", "all"}))
        ->type_name("NAME")
        ->group(camera);
    app.add_option("--zoom", o.scene.camera.zoom, "All F times larger, from the same place (default 1)")
        ->type_name("F")
        ->group(camera);
}

// Before the camera's options are checked.
void applyTurns(TraceCommand& o) {
    o.turntable = 1;
    o.film.turn = !o.turns.empty();
    if (o.turns.empty()) return;
    const bool film = !o.film.output.empty();
    const bool once = o.turns == kOnce;
    if (once && !film)
        throw UsageError(
            "--turntable: how many pictures? write --turntable 36, or make a film with --film part.mp4 --turntable");
    const int turns = once ? 1
                           : parseIntegers(o.turns, 1, ',', "--turntable",
                                           "a whole number; put FILE before it, or write --turntable 1")[0];
    if (turns < 1 || turns > 10000) throw UsageError(fmt::format("--turntable {}: must be from 1 to 10000", o.turns));
    if (film)
        o.film.turns = turns;
    else
        o.turntable = turns;
}

void addClipOption(CLI::App& app, TraceCommand& o) {
    app.add_option("--clip", o.clip,
                   "A section: only what lies where NX x + NY y + NZ z <= D, with the cut closed; may be repeated")
        ->allow_extra_args(false)
        ->type_name("NX,NY,NZ,D")
        ->group("Picture");
}

void addMaterialOptions(CLI::App& app, TraceCommand& o) {
    completes(app.add_option("--integrator", o.render.integrator.name,
                             "path, direct, phong, ao, normal, depth, position, mask, layer, tool, "
                             "feature (default path)"),
              Completion::word,
              {"path", "direct", "phong", "ao", "normal", "depth", "position", "mask", "layer", "tool", "feature"})
        ->type_name("NAME")
        ->group(kLight);
    app.add_option("--bounces", o.render.integrator.bounces, "path: scattering events (default 3)")
        ->type_name("N")
        ->group(kLight);
    app.add_flag("--exact-translucency", o.render.integrator.exact_translucency,
                 "path: follow all light in translucent plastic to its end; without it, light that has met four "
                 "surfaces is the mean of such light near there")
        ->group(kLight);
    app.add_option("--phong", o.phong, "phong: weights, exponent and mirror's share (default 1,1,1,500,0.2)")
        ->type_name("KA,KD,KS,SHININESS,KR")
        ->group(kLight);
    addGone(app, "--environment-rows",
            "it was of --integrator environment-sum; direct has the same light, without bias");
    app.add_option("--ao-distance", o.render.integrator.ao_distance, "ao: farther things don't occlude")
        ->type_name("LENGTH")
        ->group(kLight);
    std::vector<std::string> materials = shade::brdfNames();
    std::string forms;
    for (const auto& [form, meaning] : shade::brdfForms()) {
        materials.emplace_back(form.substr(0, form.find(':') + 1));
        forms += fmt::format("{}{}, ", form, meaning.empty() ? "" : fmt::format(" ({})", meaning));
    }
    completes(app.add_option("--brdf", o.scene.brdf,
                             forms + "a measured table (Mini-Diff, Zemax, ASTM E1392, "
                                     "MERL, EXR), the name of one in data/brdf, e.g. pla-blue, or a colour (default: "
                                     "the filament's colours if "
                                     "the file states them)"),
              Completion::preset, materials)
        ->type_name("SPEC|FILE|NAME")
        ->group(kLight);
    app.add_option(
           "--color", o.color,
           "Plastic of this colour: '#ff6600', a name as in CSS, e.g. teal, or a real filament's, e.g. 'Prusament "
           "Galaxy Black'; of G-code also several, a colour a tool")
        ->excludes("--brdf")
        ->type_name("COLOR,...")
        ->group(kLight);
    addColorList(app, kLight);
    const std::vector<std::string_view> attributes = voxelize::attributeNames();
    auto* by = app.add_option("--color-by", o.scene.color_by,
                              fmt::format("Colours by a grid of gcode2vdb --grids: {}", fmt::join(attributes, ", ")));
    completes(by, Completion::word, {attributes.begin(), attributes.end()})->type_name("NAME")->group(kLight);
    app.add_option("--color-range", o.color_range,
                   "Values at the ends of the ramp of --color-by, e.g. 20,80; what lies beyond has the end's colour "
                   "(default: the least and the most)")
        ->needs(by)
        ->type_name("MIN,MAX")
        ->group(kLight);
    app.add_flag("--legend", o.legend, "Draws what the colours of --color-by mean into the picture")->group(kLight);
    app.add_option("--normals", o.normals, "geometric, or smooth: without the facets of voxels (default geometric)")
        ->check(oneOf({"geometric", "smooth"}))
        ->type_name("NAME")
        ->group(kLight);
}

void addLightOptions(CLI::App& app, TraceCommand& o) {
    completes(app.add_option("--env", o.scene.env,
                             "studio, sky, sky:ELEVATION,AZIMUTH,TURBIDITY, constant:R,G,B, or a .hdr or .exr map "
                             "(default studio)"),
              Completion::preset, {"studio", "sky", "sky:", "constant:"})
        ->type_name("SPEC|FILE")
        ->group(kLight);
    app.add_option("--env-rotation", o.scene.env_rotation, "Turns it counter-clockwise as seen from above")
        ->type_name("DEG")
        ->group(kLight);
    app.add_option("--env-exposure", o.scene.env_exposure, "Stops, for maps; then --exposure is 0 by default")
        ->each([&o](const std::string&) { o.exposure_given = true; })
        ->type_name("EV")
        ->group(kLight);
    completes(app.add_option("--light", o.scene.lights,
                             "directional:X,Y,Z,R,G,B (the way it travels, irradiance), sun: the same and its DEGREES, "
                             "point:X,Y,Z,R,G,B (place, intensity), rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B (centre, "
                             "half edges, radiance; both sides shine), ambient:R,G,B; may be repeated"),
              Completion::word, {"directional:", "sun:", "point:", "rectangle:", "ambient:"})
        ->allow_extra_args(false)
        ->type_name("SPEC")
        ->group(kLight);
    app.add_option("--write-brdf", o.write_brdf, "Also write the material as a MERL .binary or an .exr texture")
        ->type_name("FILE")
        ->group(kLight);
    app.add_flag("--bed,!--no-bed", o.scene.bed, "A seamless bed under the print (the default)")->group(kLight);
    app.add_option("--bed-surface", o.bed_surface, "paper, pei, or grid of 10 mm (default paper)")
        ->check(oneOf(shade::kBedSurfaces))
        ->type_name("NAME")
        ->group(kLight);
    app.add_option_function<std::string>(
           "--background", [&o](const std::string& text) { o.scene.transparent = text == "none"; },
           "What is behind the print: scene, the bed and its backdrop or the map of light, or none: transparent, with "
           "the shadow on the bed (default scene)")
        ->check(oneOf({"scene", "none"}))
        ->type_name("NAME")
        ->group(kLight);
}

void addShardOptions(CLI::App& app, TraceCommand& o) {
    const char* machines = "Several machines";
    auto* shard =
        app.add_option(
               "--shard", o.shard.text,
               "The share I of N, I from 0, of a picture or a series; slurm takes both from a task of its array, "
               "slurm/N its number. vdbmerge puts the parts of a picture, OUT.IofN.exr, together")
            ->type_name("I/N|slurm|slurm/N")
            ->group(machines);
    app.add_option(
           "--shard-by", o.shard.by,
           "tiles: a piece of each picture, or frames: whole pictures of a series (default: frames of a series, "
           "tiles of one picture)")
        ->check([](const std::string& text) {
            return text == "samples" ? "samples are no longer shared; use tiles, which have the same bytes" : "";
        })
        ->check(oneOf({"tiles", "frames"}))
        ->needs(shard)
        ->type_name("NAME")
        ->group(machines);
    app.add_flag("--resume", o.shard.resume,
                 "Skips a part that is there and says that it is of this scene and shard; of frames, those that "
                 "OUT.IofN.done says it finished")
        ->needs(shard)
        ->group(machines);
}

void addTracingOptions(CLI::App& app, TraceCommand& o) {
    const char* tracing = "Tracing";
    app.add_option(
           "--march", o.march,
           "brick (exact), sphere (sphere tracing), vdb (OpenVDB's own), or auto, which is brick (default auto)")
        ->check(oneOf({"auto", "brick", "sphere", "vdb"}))
        ->type_name("NAME")
        ->group(tracing);
    app.add_option("--brick-values", o.values,
                   "brick: keep samples as float, or as int16, half of the memory, rounded to a 32767th of the narrow "
                   "band's half-width (default int16)")
        ->transform(enumeration({{"float", static_cast<int>(march::BrickValues::Float32)},
                                 {"int16", static_cast<int>(march::BrickValues::Int16)}}))
        ->type_name("float|int16")
        ->group(tracing);
}

}  // namespace

void addTraceOptions(CLI::App& app, TraceCommand& o) {
    addInputOptions(app, o);
    addPictureOptions(app, o);
    addCameraOptions(app, o);
    addClipOption(app, o);
    addMaterialOptions(app, o);
    addLightOptions(app, o);
    addTracingOptions(app, o);
    addShardOptions(app, o);
    addTracePrintOptions(app, o.prints, o.brick_cache);
    addFilmOptions(app, o.film, o.nozzle);
    addCommonOptions(app, o.common, traceBrief());
    app.footer(kTraceExamples);
}

void readScene(TraceCommand& o, int argc, char** argv) {
    const fs::path path = o.inputs.front();
    if (!isScene(path, o.inputs.size() == 1)) return;
    if (o.inputs.size() > 1)
        throw UsageError(fmt::format("{}: a scene stands alone; series are of level sets, but --each takes scenes, too",
                                     o.inputs.front()));
    const assemble::SceneFile file = assemble::readSceneFile(path);
    TraceCommand over;
    over.scene = file.scene;
    over.render = file.render;
    over.tone = file.tone;
    over.spp_given = file.spp_given;
    over.exposure_given = file.exposure_given;
    over.denoise = file.denoise;
    over.file_up = file.file_up;
    CLI::App app;
    addTraceOptions(app, over);
    app.parse(argc, argv);
    // With objects only its name is used.
    over.inputs = {file.objects.empty() ? file.print : path.string()};
    over.objects = file.objects;
    over.scene_text = sha256Hex(InputFile(path).bytes());
    over.notes = file.notes;
    if (over.grid.empty()) over.grid = file.grid;
    if (!over.objects.empty() && !over.grid.empty())
        throw UsageError("--grid: the scene has objects; each names its own");
    if (over.output.empty() && over.film.output.empty())
        over.output = file.output.empty() ? path.filename().replace_extension(".png").string() : file.output;
    o = std::move(over);
}

std::vector<std::string> inputFilesOf(const TraceCommand& o) {
    return assemble::inputFiles(o.objects, o.scene, o.prints.print.printer, o.film.camera_path);
}

std::string sourceOf(const TraceCommand& o, const std::string& files) {
    std::string text = fmt::format("vdbtrace {}\n{}{}\n", STRATUM_VERSION, o.said, files);
    for (const std::string& file : inputFilesOf(o)) text += assemble::identityOf(file) + "\n";
    if (!o.scene_text.empty()) text += o.scene_text;
    return sha256Hex(text).substr(0, 32);
}

void applyText(TraceCommand& o) {
    if (!o.size.empty()) {
        const auto size = parseIntegers(o.size, 2, 'x', "--size", "WxH in pixels, e.g. 1280x960");
        o.render.width = size[0];
        o.render.height = size[1];
    }
    if (!o.crop.empty()) {
        const auto c = parseIntegers(o.crop, 4, ',', "--crop", "X0,Y0,X1,Y1 in pixels");
        o.render.crop = shade::PixelBox{c[0], c[1], c[2], c[3]};
    }
    if (!o.color_range.empty()) {
        const auto ends = parseNumbers(o.color_range, {2}, "--color-range", "MIN,MAX");
        if (!(ends[0] < ends[1]))
            throw UsageError(fmt::format("--color-range {}: MIN is not below MAX", o.color_range));
        o.scene.color_range = {ends[0], ends[1]};
    }
    if (!o.phong.empty()) {
        const auto v = parseNumbers(o.phong, {5}, "--phong", "KA,KD,KS,SHININESS,KR");
        o.render.integrator.phong = {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]),
                                     static_cast<float>(v[3]), static_cast<float>(v[4])};
    }
    if (!o.aov.empty()) o.render.aovs = shade::parseAovs(o.aov);
    if (!o.view.empty()) o.scene.camera.view = shade::parseView(o.view);
    if (!o.eye.empty()) o.scene.camera.eye = parseVector(o.eye, "--eye");
    if (!o.look_at.empty()) o.scene.camera.look_at = parseVector(o.look_at, "--look-at");
    if (!o.up.empty()) o.scene.camera.up = parseVector(o.up, "--up");
    if (!o.focus.empty()) {
        const std::vector<double> focus = parseNumbers(o.focus, {1, 3}, "--focus", "a distance or a point X,Y,Z");
        o.scene.camera.focus_distance.reset();
        o.scene.camera.focus_point.reset();
        if (focus.size() == 1) o.scene.camera.focus_distance = focus[0];
        if (focus.size() == 3) o.scene.camera.focus_point = glm::dvec3(focus[0], focus[1], focus[2]);
    }
    o.clip_planes.clear();
    for (const std::string& text : o.clip) {
        const std::vector<double> v = parseNumbers(text, {4}, "--clip", "NX,NY,NZ,D");
        o.clip_planes.push_back({{v[0], v[1], v[2]}, v[3]});
    }
    if (!o.color.empty()) {
        if (colorsTools(o)) {
            assemble::ToolColors tools = assemble::toolColorsOf(o.color, "--color");
            o.prints.print.read.filament_colors = std::move(tools.colors);
            o.finishes = std::move(tools.finishes);
            o.scene.brdf.clear();  // a scene file's
        } else {
            o.scene.brdf = shade::colorNamed(o.color, "--color").brdf;
        }
    }
    if (!o.normals.empty()) o.scene.smooth_normals = o.normals == "smooth";
    if (!o.bed_surface.empty()) o.scene.bed_surface = shade::parseBedSurface(o.bed_surface);
    applyTurns(o);
    o.scene.camera.all_around = o.turntable > 1;
    o.render.validate();
    o.scene.camera.validate();
    o.tone.validate();
}

}  // namespace stratum::tools
