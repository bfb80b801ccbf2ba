// vdbtrace: level set -> picture.
#include "command_line.h"

#include "io/error.h"
#include "march/brick_intersector.h"
#include "march/level_set_file.h"
#include "march/sphere_intersector.h"
#include "march/vdb_intersector.h"
#include "shade/picture.h"
#include "shade/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
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
    std::string input, output, grid, march = "auto", size = "1280x960", view = "iso", crop;
    std::vector<double> eye, look_at, up;
    shade::SceneOptions scene;
    shade::RenderOptions render;
    shade::ToneOptions tone;
};

void addOptions(CLI::App& app, Options& o) {
    app.add_option("IN", o.input, "A level set")->required()->type_name("FILE.vdb");
    app.add_option("-o,--output", o.output, "A tone-mapped .png or a linear .exr")->type_name("FILE");
    app.add_option("--grid", o.grid, "Which grid (default: surface, or the only level set)")->type_name("NAME");

    const char* picture = "Picture";
    app.add_option("--size", o.size, "Pixels (default 1280x960)")->type_name("WxH")->group(picture);
    app.add_option("--spp", o.render.spp, "Samples a pixel (default 16)")->type_name("N")->group(picture);
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
    app.add_option("--integrator", o.render.integrator.name, "path, direct, ao, normal, depth (default path)")
        ->type_name("NAME")
        ->group(light);
    app.add_option("--bounces", o.render.integrator.bounces, "path: scattering events (default 3)")
        ->type_name("N")
        ->group(light);
    app.add_option("--ao-distance", o.render.integrator.ao_distance, "ao: farther things don't occlude")
        ->type_name("LENGTH")
        ->group(light);
    app.add_option("--brdf", o.scene.brdf, "lambert:R,G,B or plastic:R,G,B,ALPHA (GGX alpha)")
        ->type_name("SPEC")
        ->group(light);
    app.add_option("--env", o.scene.env, "studio or constant:R,G,B (default studio)")->type_name("SPEC")->group(light);
    app.add_option("--light", o.scene.lights, "directional:X,Y,Z,R,G,B, towards the light; may be repeated")
        ->type_name("SPEC")
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
    const auto size = parseIntegers<2>(o.size, 'x', "--size", "WxH in pixels, e.g. 1280x960");
    o.render.width = size[0];
    o.render.height = size[1];
    if (!o.crop.empty()) {
        const auto c = parseIntegers<4>(o.crop, ',', "--crop", "X0,Y0,X1,Y1 in pixels");
        o.render.crop = shade::PixelBox{c[0], c[1], c[2], c[3]};
    }
    o.scene.camera.view = shade::parseView(o.view);
    o.scene.camera.eye = toVector(o.eye);
    o.scene.camera.look_at = toVector(o.look_at);
    o.scene.camera.up = toVector(o.up);
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

void run(Options& o) {
    applyText(o);
    const tools::ThreadLimit limit(o.common.threads);
    tools::Stopwatch total;
    tools::Stopwatch watch;
    if (o.output.empty()) o.output = fs::path(o.input).filename().replace_extension(".png").string();
    refuseOtherFormats(o.input);
    shade::PictureFile picture(o.output);

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

    const std::string source = fs::path(o.input).filename().string();
    shade::Metadata metadata{{"Software", "vdbtrace " STRATUM_VERSION},
                             {"Source", source},
                             {"Integrator", o.render.integrator.name},
                             {"SamplesPerPixel", std::to_string(o.render.spp)},
                             {"Seed", std::to_string(o.render.seed)},
                             {"Brdf", o.scene.brdf},
                             {"Environment", o.scene.env}};
    picture.write(result.film, metadata, o.tone);
    const double write_seconds = watch.lap();
    const double total_seconds = total.lap();

    const shade::RayCounts& rays = result.rays;
    const double mrays = static_cast<double>(rays.total()) / render_seconds * 1e-6;
    tools::say(o.common, fmt::format("  {}: {} x {} at {} spp, {} rays, {:.1f} Mrays/s, {:.2f} s in all", o.output,
                                     o.render.width, o.render.height, o.render.spp,
                                     tools::humanCount(static_cast<double>(rays.total())), mrays, total_seconds));
    Json skipped = Json::array();
    const auto skip = [&skipped](const char* what, const char* why, const char* saved) {
        skipped.push_back({{"what", what}, {"why", why}, {"saved", saved}});
    };
    if (!scene.bed) skip("bed", o.scene.bed ? "the camera is below it" : "--no-bed", "its shading and bounces");
    if (scene.lights.empty()) skip("directional lights", "none asked for", "one shadow ray a hit and light");
    if (o.render.integrator.name != "path" && o.render.integrator.name != "direct")
        skip("light and material", "the integrator does not shade", "shadow and bounce rays");
    tools::writeStats(
        o.common,
        {{"input", input},
         {"output", o.output},
         {"image", {{"width", o.render.width}, {"height", o.render.height}, {"spp", o.render.spp}}},
         {"rays",
          {{"primary", rays.primary}, {"shadow", rays.shadow}, {"bounce", rays.bounce}, {"total", rays.total()}}},
         {"march", intersector->name()},
         {"march_bytes", intersector->bytes()},
         {"integrator", o.render.integrator.name},
         {"seconds",
          {{"load", load_seconds},
           {"build", build_seconds},
           {"render", render_seconds},
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
    return tools::runTool(app, argc, argv, [&options] { run(options); });
}
