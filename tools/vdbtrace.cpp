// vdbtrace: level set -> picture.
#include "command_line.h"

#include "io/error.h"
#include "io/mapped_file.h"
#include "march/brick_intersector.h"
#include "march/level_set_file.h"
#include "march/sphere_intersector.h"
#include "march/vdb_intersector.h"
#include "shade/brdf_file.h"
#include "shade/denoise.h"
#include "shade/picture.h"
#include "shade/render.h"
#include "shade/scene_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace {

using namespace stratum;
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kExamples = R"(
Examples:
  vdbtrace part.vdb                                 part.png, 1280 x 960, studio light
  vdbtrace part.vdb -o part.png --view front --spp 64
  vdbtrace part.vdb -o part.exr --integrator ao     linear values, for compositing and measuring
  vdbtrace part.vdb --brdf plastic:0.8,0.1,0.05,0.2 --env constant:1,1,1
  vdbtrace part.vdb --eye 120,-200,90 --look-at 0,0,20 --fov 25)";

struct Options {
    tools::CommonOptions common;
    std::string input, output, grid, march = "auto", size, view, crop, write_brdf, aov;
    std::vector<double> eye, look_at, up;
    std::vector<float> phong;
    bool spp_given = false, denoise = false;
    shade::SceneOptions scene;
    shade::RenderOptions render;
    shade::ToneOptions tone;
};

void addOptions(CLI::App& app, Options& o) {
    app.add_option("IN", o.input, "A level set, or a scene that names one; options override the scene")
        ->required()
        ->type_name("FILE.vdb|SCENE.json");
    app.add_option("-o,--output", o.output, "A tone-mapped .png or a linear .exr")->type_name("FILE");
    app.add_option("--grid", o.grid, "Which grid (default: surface, or the only level set)")->type_name("NAME");

    const char* picture = "Picture";
    app.add_option("--size", o.size, "Pixels (default 1280x960)")->type_name("WxH")->group(picture);
    app.add_option("--spp", o.render.spp, "Samples a pixel (default 16)")
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
    app.add_option("--aov", o.aov, "More layers, for .exr: normal, depth, position, albedo, mask, variance, samples")
        ->type_name("NAME,...")
        ->group(picture);
    app.add_flag("--denoise", o.denoise, "Takes noise out of the finished picture, guided by normals, depth and albedo")
        ->group(picture);
    app.add_option("--seed", o.render.seed, "Another seed, another noise")->type_name("N")->group(picture);
    app.add_option("--crop", o.crop, "Only these pixels of the same picture")->type_name("X0,Y0,X1,Y1")->group(picture);
    app.add_option("--exposure", o.tone.exposure, "Stops, for .png")->type_name("EV")->group(picture);

    const char* camera = "Camera";
    app.add_option("--view", o.view, "iso, front, back, left, right, top, bottom (default iso)")
        ->type_name("NAME")
        ->group(camera);
    const auto vector = [&](const char* name, std::vector<double>& value, const char* help) {
        return app.add_option(name, value, help)->delimiter(',')->expected(3)->type_name("X,Y,Z")->group(camera);
    };
    auto* eye = vector("--eye", o.eye, "Where the camera stands, in the world units of the .vdb");
    vector("--look-at", o.look_at, "What it looks at (default: the middle of the part)")->needs(eye);
    vector("--up", o.up, "Which way is up (default 0,0,1)");
    app.add_option("--fov", o.scene.camera.fov, "Vertical angle of view (default 28)")->type_name("DEG")->group(camera);

    const char* light = "Light and material";
    app.add_option("--integrator", o.render.integrator.name,
                   "path, direct, environment-sum, phong, ao, normal, depth, position, mask (default path)")
        ->type_name("NAME")
        ->group(light);
    app.add_option("--bounces", o.render.integrator.bounces, "path: scattering events (default 3)")
        ->type_name("N")
        ->group(light);
    app.add_option("--phong", o.phong, "phong: weights, exponent and mirror's share (default 1,1,1,500,0.2)")
        ->delimiter(',')
        ->expected(5)
        ->type_name("KA,KD,KS,SHININESS,KR")
        ->group(light);
    app.add_option("--environment-rows", o.render.integrator.environment_rows,
                   "environment-sum: rows of its map, twice as many columns (default 32)")
        ->type_name("N")
        ->group(light);
    app.add_option("--ao-distance", o.render.integrator.ao_distance, "ao: farther things don't occlude")
        ->type_name("LENGTH")
        ->group(light);
    app.add_option(
           "--brdf", o.scene.brdf,
           "lambert:R,G,B, plastic:R,G,B,ALPHA (GGX alpha), a measured table (Mini-Diff, Zemax, ASTM E1392, MERL, "
           "EXR), or the name of one in data/brdf, e.g. pla-blue")
        ->type_name("SPEC|FILE|NAME")
        ->group(light);
    app.add_option(
           "--env", o.scene.env,
           "studio, sky, sky:ELEVATION,AZIMUTH,TURBIDITY, constant:R,G,B, or a .hdr or .exr map (default studio)")
        ->type_name("SPEC|FILE")
        ->group(light);
    app.add_option("--env-rotation", o.scene.env_rotation, "Turns it counter-clockwise as seen from above")
        ->type_name("DEG")
        ->group(light);
    app.add_option("--env-exposure", o.scene.env_exposure, "Stops, for maps")->type_name("EV")->group(light);
    app.add_option("--light", o.scene.lights,
                   "directional:X,Y,Z,R,G,B (the way it travels, irradiance), sun: the same and its DEGREES, "
                   "point:X,Y,Z,R,G,B (place, intensity), rectangle:X,Y,Z,UX,UY,UZ,VX,VY,VZ,R,G,B (centre, half edges, "
                   "radiance), ambient:R,G,B; may be repeated")
        ->type_name("SPEC")
        ->group(light);
    app.add_option("--write-brdf", o.write_brdf, "Also write the material as a MERL .binary or an .exr texture")
        ->type_name("FILE")
        ->group(light);
    app.add_flag("--bed,!--no-bed", o.scene.bed, "A seamless bed under the print (the default)")->group(light);

    const char* tracing = "Tracing";
    app.add_option(
           "--march", o.march,
           "brick (exact), sphere (sphere tracing), vdb (OpenVDB's own), or auto, which is brick (default auto)")
        ->check(CLI::IsMember({"auto", "brick", "sphere", "vdb"}))
        ->type_name("NAME")
        ->group(tracing);
    tools::addCommonOptions(app, o.common);
    app.footer(kExamples);
}

// "a<separator>b..." as exactly N whole numbers.
template <std::size_t N>
std::array<int, N> parseIntegers(const std::string& text, char separator, const char* option, const char* expected) {
    std::array<int, N> values{};
    std::string_view rest = text;
    for (std::size_t n = 0; n < N; ++n) {
        const std::size_t end = n + 1 < N ? rest.find(separator) : rest.size();
        const std::string_view part = rest.substr(0, std::min(end, rest.size()));
        const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), values[n]);
        if (end == std::string_view::npos || error != std::errc{} || stop != part.data() + part.size())
            throw UsageError(fmt::format("{} {}: expected {}", option, text, expected));
        if (n + 1 < N) rest.remove_prefix(end + 1);
    }
    return values;
}

std::optional<glm::dvec3> toVector(const std::vector<double>& values) {
    if (values.empty()) return std::nullopt;
    return glm::dvec3(values[0], values[1], values[2]);
}

void applyText(Options& o) {
    if (!o.size.empty()) {
        const auto size = parseIntegers<2>(o.size, 'x', "--size", "WxH in pixels, e.g. 1280x960");
        o.render.width = size[0];
        o.render.height = size[1];
    }
    if (!o.crop.empty()) {
        const auto c = parseIntegers<4>(o.crop, ',', "--crop", "X0,Y0,X1,Y1 in pixels");
        o.render.crop = shade::PixelBox{c[0], c[1], c[2], c[3]};
    }
    if (!o.phong.empty()) o.render.integrator.phong = {o.phong[0], o.phong[1], o.phong[2], o.phong[3], o.phong[4]};
    if (!o.aov.empty()) o.render.aovs = shade::parseAovs(o.aov);
    if (!o.view.empty()) o.scene.camera.view = shade::parseView(o.view);
    if (!o.eye.empty()) o.scene.camera.eye = toVector(o.eye);
    if (!o.look_at.empty()) o.scene.camera.look_at = toVector(o.look_at);
    if (!o.up.empty()) o.scene.camera.up = toVector(o.up);
    o.render.validate();
    o.scene.camera.validate();
    o.tone.validate();
}

// People hand over what they have; say which tool takes it.
void refuseOtherFormats(const std::string& input) {
    std::ifstream file(input, std::ios::binary);
    if (!file) throw InputError(fmt::format("{}: can't be opened; check the name and the permissions", input));
    std::array<char, 4> magic{};
    file.read(magic.data(), magic.size());
    if (file.gcount() == 0) throw InputError(fmt::format("{}: is empty (0 bytes)", input));
    if (std::string_view(magic.data(), magic.size()) == std::string_view(" BDV", 4)) return;
    const std::string extension = fs::path(input).extension().string();
    if (extension == ".gcode" || extension == ".gco" || extension == ".g")
        throw InputError(fmt::format("{}: is G-code; make a level set of it first: gcode2vdb {}", input, input));
    throw InputError(fmt::format("{}: is not an OpenVDB file; expected a .vdb with a level set", input));
}

// What the file says its world unit is; other programs' files don't say.
std::string unitOf(const openvdb::FloatGrid& grid) {
    const auto unit = grid.getMetadata<openvdb::StringMetadata>("unit");
    return unit ? unit->value() : "world units";
}

// If the input is a scene, its values become the defaults and the command line is read once more over them.
void readScene(Options& o, int argc, char** argv) {
    const fs::path path = o.input;
    if (!shade::isSceneFile(MappedFile(path).bytes())) return;
    const shade::SceneFile file = shade::readSceneFile(path);
    const auto over = std::make_unique<Options>();
    over->scene = file.scene;
    over->render = file.render;
    over->tone = file.tone;
    over->spp_given = file.spp_given;
    CLI::App app;
    addOptions(app, *over);
    app.parse(argc, argv);
    over->input = file.print;
    if (over->grid.empty()) over->grid = file.grid;
    if (over->output.empty())
        over->output = file.output.empty() ? path.filename().replace_extension(".png").string() : file.output;
    o = *over;
}

void run(Options& o, int argc, char** argv) {
    readScene(o, argc, argv);
    if ((o.render.noise > 0.0 || o.render.seconds > 0.0) && !o.spp_given) o.render.spp = 4096;
    applyText(o);
    const tools::ThreadLimit limit(o.common.threads);
    tools::Stopwatch total;
    tools::Stopwatch watch;
    if (o.output.empty()) o.output = fs::path(o.input).filename().replace_extension(".png").string();
    refuseOtherFormats(o.input);
    shade::PictureFile picture(o.output);
    if (!o.render.aovs.empty() && !picture.linear())
        throw UsageError(fmt::format("--aov: layers need a picture that holds them; write an .exr, not {}", o.output));

    if (o.denoise) shade::addDenoisingGuides(o.render);

    openvdb::initialize();
    openvdb::FloatGrid::ConstPtr grid = march::readLevelSet(o.input, o.grid);
    const Json input{{"path", o.input},
                     {"grid", grid->getName()},
                     {"active_voxels", grid->activeVoxelCount()},
                     {"bytes", grid->memUsage()}};
    tools::say(o.common, fmt::format("{}: {} active voxels of {:g} {}", o.input,
                                     tools::humanCount(static_cast<double>(grid->activeVoxelCount())),
                                     grid->voxelSize()[0], unitOf(*grid)));
    const double load_seconds = watch.lap();
    const auto intersector = o.march == "vdb"      ? march::makeVdbIntersector(grid)
                             : o.march == "sphere" ? march::makeSphereIntersector(grid)
                                                   : march::makeBrickIntersector(*grid);
    grid.reset();  // bricks hold all that rays need
    const shade::SceneDescription scene = shade::makeScene(o.scene, *intersector, o.render.width, o.render.height);
    for (const std::string& note : scene.material->notes()) tools::say(o.common, "  material: " + note);
    if (!o.write_brdf.empty()) shade::writeBrdfFile(o.write_brdf, *scene.material);
    const double build_seconds = watch.lap();
    shade::RenderResult result;
    {
        tools::ProgressBar bar("rendering", o.common.quiet);
        shade::Progress progress;
        if (const auto show = bar.callback())
            progress = [show](std::uint64_t done, std::uint64_t all) {
                show(static_cast<double>(done) / static_cast<double>(all));
            };
        result = shade::render(*intersector, scene, o.render, progress);
    }
    const double render_seconds = watch.lap();
    if (o.denoise) shade::denoise(result.film);
    const double denoise_seconds = watch.lap();

    const std::string source = fs::path(o.input).filename().string();
    shade::Metadata metadata{{"Software", "vdbtrace " STRATUM_VERSION},
                             {"Source", source},
                             {"Integrator", o.render.integrator.name},
                             {"SamplesPerPixel", fmt::format("{:g}", result.mean_spp)},
                             {"Seed", std::to_string(o.render.seed)},
                             {"Brdf", o.scene.brdf},
                             {"Environment", o.scene.env}};
    if (!scene.material->notes().empty())
        metadata.insert({"BrdfNotes", fmt::format("{}", fmt::join(scene.material->notes(), "; "))});
    if (o.denoise) metadata.insert({"Denoised", shade::kDenoiserLabel});
    if (o.render.seconds > 0.0)
        metadata.insert({"Time", fmt::format("{:g} s; the samples depend on the machine", o.render.seconds)});
    picture.write(result.film, metadata, o.tone);
    if (!o.render.checkpoint.empty()) fs::remove(o.render.checkpoint);  // the picture is there
    const double write_seconds = watch.lap();
    const double total_seconds = total.lap();

    const shade::RayCounts& rays = result.rays;
    const double mrays = static_cast<double>(rays.total()) / render_seconds * 1e-6;
    tools::say(o.common, fmt::format("  {}: {} x {} at {:.4g} spp, {} rays, {:.1f} Mrays/s, {:.2f} s in all", o.output,
                                     o.render.width, o.render.height, result.mean_spp,
                                     tools::humanCount(static_cast<double>(rays.total())), mrays, total_seconds));
    Json skipped = Json::array();
    const auto skip = [&skipped](const char* what, const char* why, const char* saved) {
        skipped.push_back({{"what", what}, {"why", why}, {"saved", saved}});
    };
    if (!scene.bed) skip("bed", o.scene.bed ? "the camera is below it" : "--no-bed", "its shading and bounces");
    if (scene.lights.empty()) skip("lamps", "none asked for", "one shadow ray a hit and light");
    if (result.film.content() != shade::FilmContent::radiance)
        skip("light and material", "the integrator does not shade", "shadow and bounce rays");
    tools::writeStats(
        o.common,
        {{"input", input},
         {"output", o.output},
         {"image",
          {{"width", o.render.width},
           {"height", o.render.height},
           {"spp", o.render.spp},
           {"mean_spp", result.mean_spp}}},
         {"rays",
          {{"primary", rays.primary}, {"shadow", rays.shadow}, {"bounce", rays.bounce}, {"total", rays.total()}}},
         {"march", intersector->name()},
         {"march_bytes", intersector->bytes()},
         {"integrator", o.render.integrator.name},
         {"material", {{"brdf", o.scene.brdf}, {"notes", scene.material->notes()}}},
         {"seconds",
          {{"load", load_seconds},
           {"build", build_seconds},
           {"render", render_seconds},
           {"denoise", denoise_seconds},
           {"write", write_seconds},
           {"total", total_seconds}}},
         {"mrays_per_second", mrays},
         {"peak_rss_bytes", tools::peakRssBytes()},
         {"threads", limit.threads()},
         {"skipped", skipped}});
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Ray-traces an OpenVDB level set into a picture.", "vdbtrace");
    Options options;
    addOptions(app, options);
    return tools::runTool(app, argc, argv, [&] { run(options, argc, argv); });
}
