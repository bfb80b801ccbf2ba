#include "trace_options.h"
#include "shade/finish/named_brdf.h"

#include "choices.h"
#include "color_options.h"
#include "command_source.h"
#include "print_options.h"

#include "assemble/file/file_facts.h"
#include "assemble/file/input_files.h"
#include "assemble/scene_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/input_file.h"
#include "base/text.h"
#include "gcode/container/container.h"
#include "voxelize/grid/attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>
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

// Most are declared without a variable: assemble::readPicture() asks for them.

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
    const Declarations input(app, "Options");
    input("--grid", "NAME", "Which grid (default: surface, or the only level set)");
    completes(
        input("--file-up", "AXIS", "Which axis of the level set points up: z or y (default: what the file says, or z)"),
        Completion::word, {"z", "y"});
}

void addPictureOptions(CLI::App& app, TraceCommand& o) {
    const char* group = "Picture";
    const Declarations picture(app, group);
    picture("--size", "WxH", "Pixels (default 1280x960)");
    picture("--spp", "N", "Samples a pixel (default 16; if denoised 8, small pictures more)");
    picture("--noise", "T",
            "Samples until the relative error is this, e.g. 0.05, but no more than --spp (then 4096 by default)");
    picture("--time", "SECONDS",
            "Samples until this time is over, the noisiest tiles first; another machine, another picture");
    app.add_option("--checkpoint", o.checkpoint,
                   "Keeps what is finished in this file and goes on from there; the picture is the same")
        ->type_name("FILE")
        ->group(group);
    completes(
        picture("--aov", "NAME,...", fmt::format("More layers, for .exr: {}", fmt::join(shade::aovNames(), ", "))),
        Completion::list, shade::aovNames());
    picture.flag("--denoise,!--no-denoise",
                 "Takes noise out of the finished picture, guided by its geometry (the default of pictures of light, "
                 "but .exr)");
    picture("--seed", "N", "Another seed, another noise");
    picture("--crop", "X0,Y0,X1,Y1", "Only these pixels of the same picture");
    picture("--exposure", "EV", "Stops, for pictures to look at (default: found from the light)");
}

void addCameraOptions(CLI::App& app, TraceCommand& o) {
    const char* group = "Camera";
    const Declarations camera(app, group);
    completes(camera("--view", "NAME", "iso, front, back, left, right, top, bottom (default iso)"), Completion::word,
              wordsOf(shade::kViews));
    camera("--eye", "X,Y,Z", "Where the camera stands, in the world units of the .vdb");
    camera("--look-at", "X,Y,Z", "What it looks at (default: the middle of the part)");
    camera("--up", "X,Y,Z", "Which way is up (default 0,0,1)");
    camera("--f-number", "N", "Depth of field of a camera with a picture 24 mm high");
    camera("--aperture", "LENGTH", "The same by the diameter of the lens, in world units");
    camera("--focus", "LENGTH|X,Y,Z", "Distance that is sharp, or a point (default: the middle of the part)");
    app.add_option("--turntable", o.turns,
                   "N numbered pictures from all around; of a film: the camera goes round N times (default 1)")
        ->expected(0, 1)
        ->default_str(kOnce)
        ->type_name("[N]")
        ->group(group);
    camera("--fov", "DEG", "Vertical angle of view (default 28)");
    completes(camera("--frame", "NAME",
                     "What a named view is fitted to: part, without skirts, prime towers and start lines, or all that "
                     "is there (default part)"),
              Completion::word, {"part", "all"});
    camera("--zoom", "F", "All F times larger, from the same place (default 1)");
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
    const std::optional<int> turns = once ? 1 : parsed<int>(o.turns);
    if (!turns)
        throw UsageError(fmt::format(
            "--turntable {}: expected a whole number; put FILE before it, or write --turntable 1", o.turns));
    if (*turns < 1 || *turns > 10000) throw UsageError(fmt::format("--turntable {}: must be from 1 to 10000", o.turns));
    if (film)
        o.film.turns = *turns;
    else
        o.turntable = *turns;
}

void addMaterialOptions(CLI::App& app) {
    const Declarations light(app, kLight);
    completes(light("--integrator", "NAME", fmt::format("{} (default path)", fmt::join(shade::kIntegratorNames, ", "))),
              Completion::word, {shade::kIntegratorNames.begin(), shade::kIntegratorNames.end()});
    light("--bounces", "N", "path: scattering events (default 3)");
    light.flag("--exact-translucency",
               "path: follow all light in translucent plastic to its end; without it, light that has met four "
               "surfaces is the mean of such light near there");
    light("--phong", "KA,KD,KS,SHININESS,KR", "phong: weights, exponent and mirror's share (default 1,1,1,500,0.2)");
    addGone(app, "--environment-rows",
            "it was of --integrator environment-sum; direct has the same light, without bias");
    light("--ao-distance", "LENGTH", "ao: farther things don't occlude");
    std::vector<std::string> materials = shade::brdfNames();
    std::string forms;
    for (const auto& [form, meaning] : shade::brdfForms()) {
        materials.emplace_back(form.substr(0, form.find(':') + 1));
        forms += fmt::format("{}{}, ", form, meaning.empty() ? "" : fmt::format(" ({})", meaning));
    }
    completes(light("--brdf", "SPEC|FILE|NAME",
                    forms + "a measured table (Mini-Diff, Zemax, ASTM E1392, MERL, EXR), the name of one in data/brdf, "
                            "e.g. pla-blue, or a colour (default: the filament's colours if the file states them)"),
              Completion::preset, materials);
    light("--color", "COLOR,...",
          "Plastic of this colour: '#ff6600', a name as in CSS, e.g. teal, or a real filament's, e.g. 'Prusament "
          "Galaxy Black'; of G-code also several, a colour a tool")
        ->excludes("--brdf");
    addColorList(app, kLight);
    const std::vector<std::string_view> attributes = voxelize::attributeNames();
    completes(light("--color-by", "NAME",
                    fmt::format("Colours by a grid of gcode2vdb --grids: {}", fmt::join(attributes, ", "))),
              Completion::word, {attributes.begin(), attributes.end()});
    light("--color-range", "MIN,MAX",
          "Values at the ends of the ramp of --color-by, e.g. 20,80; what lies beyond has the end's colour (default: "
          "the least and the most)");
    light.flag("--legend", "Draws what the colours of --color-by mean into the picture");
    completes(light("--normals", "NAME", "geometric, or smooth: without the facets of voxels (default geometric)"),
              Completion::word, {"geometric", "smooth"});
}

void addLightOptions(CLI::App& app, TraceCommand& o) {
    const Declarations light(app, kLight);
    completes(light("--env", "SPEC|FILE",
                    "studio, sky, sky:ELEVATION,AZIMUTH,TURBIDITY, constant:R,G,B, or a .hdr or .exr map (default "
                    "studio)"),
              Completion::preset, {"studio", "sky", "sky:", "constant:"});
    light("--env-rotation", "DEG", "Turns it counter-clockwise as seen from above");
    light("--env-exposure", "EV", "Stops, for maps; then --exposure is 0 by default");
    completes(light.several("--light", "SPEC",
                            "directional:X,Y,Z,R,G,B (the way it travels, irradiance), sun: the same and its DEGREES, "
                            "point:X,Y,Z,R,G,B (place, intensity), rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B (centre, "
                            "half edges, radiance; both sides shine), ambient:R,G,B; may be repeated"),
              Completion::word, {"directional:", "sun:", "point:", "rectangle:", "ambient:"});
    app.add_option("--write-brdf", o.write_brdf, "Also write the material as a MERL .binary or an .exr texture")
        ->type_name("FILE")
        ->group(kLight);
    light.flag("--bed,!--no-bed", "A seamless bed under the print (the default)");
    completes(light("--bed-surface", "NAME", "paper, pei, or grid of 10 mm (default paper)"), Completion::word,
              wordsOf(shade::kBedSurfaces));
    completes(light("--background", "NAME",
                    "What is behind the print: scene, the bed and its backdrop or the map of light, or none: "
                    "transparent, with the shadow on the bed (default scene)"),
              Completion::word, {"scene", "none"});
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

void addTracingOptions(CLI::App& app) {
    const Declarations tracing(app, "Tracing");
    completes(tracing("--march", "NAME",
                      "brick (exact), sphere (sphere tracing), vdb (OpenVDB's own), or auto, which is brick (default "
                      "auto)"),
              Completion::word, wordsOf(assemble::kMarchMethods));
    completes(tracing("--brick-values", "float|int16",
                      "brick: keep samples as float, or as int16, half of the memory, rounded to a 32767th of the "
                      "narrow band's half-width (default int16)"),
              Completion::word, {"float", "int16"});
    tracing("--brick-cache", "SIZE",
            "brick: no more than this of samples at once, e.g. 200MB; what no ray came to lately makes room, and the "
            "picture stays the same. Of each print, and of each large level set (default: no bound)");
    addGone(app, "--brick-picture", "--stats has how many bricks rays came to, bricks_made of bricks_listed");
}

}  // namespace

void addTraceOptions(CLI::App& app, TraceCommand& o) {
    addInputOptions(app, o);
    addPictureOptions(app, o);
    addCameraOptions(app, o);
    Declarations(app, "Picture")
        .several("--clip", "NX,NY,NZ,D",
                 "A section: only what lies where NX x + NY y + NZ z <= D, with the cut closed; may be repeated");
    addMaterialOptions(app);
    addLightOptions(app, o);
    addTracingOptions(app);
    addShardOptions(app, o);
    addPrintOptions(app, true);
    addMomentOptions(app, o.tracing.prints);
    addFilmOptions(app, o.film, o.nozzle);
    addCommonOptions(app, o.common, traceBrief());
    app.footer(kTraceExamples);
}

void readPictureOptions(TraceCommand& o, const CLI::App& app) {
    const fs::path path = o.inputs.front();
    if (isScene(path, o.inputs.size() == 1)) {
        if (o.inputs.size() > 1)
            throw UsageError(fmt::format(
                "{}: a scene stands alone; series are of level sets, but --each takes scenes, too", o.inputs.front()));
        assemble::SceneFile file = assemble::readSceneFile(path);
        // With objects only its name is used.
        o.inputs = {file.objects.empty() ? file.print : path.string()};
        o.objects = std::move(file.objects);
        o.scene_file = path.string();
        o.scene_text = sha256Hex(InputFile(path).bytes());
        if (o.output.empty() && o.film.output.empty())
            o.output = file.output.empty() ? path.filename().replace_extension(".png").string() : file.output;
        file.tracing.prints = o.tracing.prints;
        static_cast<assemble::PictureRequest&>(o) = std::move(file);
    }
    CommandSource options(app);
    assemble::readPicture(options, o);
    assemble::refuseUnused(options, o);
    if (options.text("brdf") || options.text("color") || options.text("color_by"))
        for (assemble::ObjectOptions& object : o.objects) object.material = {};
    readPrintOptions(options, o.tracing.prints.print, true);
    assemble::completeSamples(o);
    if (!o.objects.empty() && options.text("grid"))
        throw UsageError("--grid: the scene has objects; each names its own");
    if (!o.checkpoint.empty()) o.render.checkpoint = o.checkpoint;
    if (!o.tool_colors.empty()) o.tracing.prints.print.read.filament_colors = o.tool_colors;
    if (o.exposure) o.tone.exposure = *o.exposure;
    applyTurns(o);
    o.scene.camera.all_around = o.turntable > 1;
    o.render.validate();
    o.scene.camera.validate();
    o.tone.validate();
}

std::vector<std::string> inputFilesOf(const TraceCommand& o) {
    return assemble::inputFiles(o.objects, o.scene, o.tracing.prints.print.printer, o.film.camera_path);
}

std::string sourceOf(const TraceCommand& o, const std::string& files) {
    std::string text = fmt::format("vdbtrace {}\n{}{}\n", STRATUM_VERSION, o.said, files);
    for (const std::string& file : inputFilesOf(o)) text += assemble::identityOf(file) + "\n";
    if (!o.scene_text.empty()) text += o.scene_text;
    return sha256Hex(text).substr(0, 32);
}

}  // namespace stratum::tools
