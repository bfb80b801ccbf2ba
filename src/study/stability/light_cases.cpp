// Light in furnaces, and lamps of all strengths.
//
// A mean of random samples is judged by its own standard error s, taken from the spread of blocks of pixels: a right
// mean is off by more than 5 s once in a million.
#include "march/brick/brick_intersector.h"
#include "shade/integrator/render.h"
#include "shade/scene/scene.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace stratum::study {
namespace {

constexpr int kSide = 96;  // pixels of the frame

std::unique_ptr<trace::Intersector> litBall() {
    openvdb::initialize();
    return march::makeBrickIntersector(
        *openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5, openvdb::Vec3f(0), 0.1F));
}

// A plate of lines with creases between them, where light goes to and fro; it fills the frame's middle.
std::unique_ptr<trace::Intersector> grooves() {
    openvdb::initialize();
    gcode::Toolpath toolpath;
    for (int n = -20; n <= 20; ++n) {
        const double across = 0.4 * n;
        addBead(toolpath, -8, across, 0.2, 8, across, 0.2, 0.45, 0.2, 1);
        addBead(toolpath, across, -8, 0.4, across, 8, 0.4, 0.35, 0.2, 2);
    }
    return march::makeBrickIntersector(*voxelize::voxelize(toolpath, allBeads(toolpath), plainLattice(0.1, 0.2)));
}

shade::SceneOptions bare(const std::string& brdf, const std::string& env) {
    shade::SceneOptions options;
    options.brdf = brdf;
    options.env = env;
    options.bed = false;
    options.backdrop = false;
    return options;
}

struct Picture {
    shade::SceneOptions scene;
    int spp = 16;
    int bounces = 3;
    std::string integrator = "path";
};

// The middle of the frame: nothing but surface.
shade::Film render(const trace::Intersector& print, const Picture& picture) {
    shade::RenderOptions options;
    options.width = options.height = kSide;
    options.spp = picture.spp;
    options.crop = shade::PixelBox{kSide * 3 / 8, kSide * 3 / 8, kSide * 5 / 8, kSide * 5 / 8};
    options.integrator.name = picture.integrator;
    options.integrator.bounces = picture.bounces;
    return shade::render(print, shade::makeScene(picture.scene, print, kSide, kSide), options).film;
}

// |mean - expected| in standard errors of the mean; infinite if a pixel is no finite number. A mean that is right to
// `exact` (relative) counts as right: what is known only to a table's or a float's digits.
double offByErrors(const shade::Film& film, double expected, double exact) {
    constexpr int kBlocks = 16;
    std::vector<double> blocks(kBlocks, 0.0);
    const auto& pixels = film.pixels();
    for (std::size_t n = 0; n < pixels.size(); ++n) {
        // Premultiplied: what of a pixel is not surface does not count.
        const double value = static_cast<double>((pixels[n].rgb.r + pixels[n].rgb.g + pixels[n].rgb.b) / 3.0F);
        if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
        blocks[n % kBlocks] += value * kBlocks / static_cast<double>(pixels.size());
    }
    double mean = 0;
    for (const double block : blocks) mean += block / kBlocks;
    double variance = 0;
    for (const double block : blocks) variance += (block - mean) * (block - mean) / (kBlocks - 1) / kBlocks;
    const double off = std::max(std::abs(mean - expected) - exact * expected, 0.0);
    return off == 0 ? 0 : off / std::sqrt(variance);
}

constexpr const char* kErrors = "5 standard errors of the mean: once in a million by chance";

StabilityCase light(std::string name, std::string quantity, double tolerance, std::string why,
                    std::function<double()> measure) {
    return {"light", std::move(name), std::move(quantity), tolerance, std::move(why), std::move(measure)};
}

double brightest(const shade::Film& film) {
    double most = 0;
    for (const shade::Pixel& pixel : film.pixels())
        for (int c = 0; c < 3; ++c) most = std::max(most, static_cast<double>(pixel.rgb[c]));
    return most;
}

// A matt ball of albedo 1 lit from behind the camera with irradiance pi: its middle shines with radiance 1.
double middleOfALitBall(double irradiance) {
    const auto print = litBall();
    Picture picture{bare("lambert:1,1,1", "constant:0,0,0"), 4, 1, "direct"};
    picture.scene.camera.eye = glm::dvec3(0, -100, 0);
    picture.scene.camera.look_at = glm::dvec3(0);
    picture.scene.lights = {fmt::format("directional:0,1,0,{0},{0},{0}", irradiance * std::numbers::pi)};
    shade::RenderOptions options;
    options.width = options.height = 501;
    options.spp = 1;
    options.crop = shade::PixelBox{250, 250, 251, 251};
    options.integrator.name = picture.integrator;
    const shade::Film film = shade::render(*print, shade::makeScene(picture.scene, *print, 501, 501), options).film;
    return std::abs(static_cast<double>(film.at(250, 250).rgb.g) / irradiance - 1);
}

void addFurnaces(std::vector<StabilityCase>& cases) {
    const auto furnace = [&cases](std::string name, const std::string& brdf, int bounces, bool convex, double exact) {
        cases.push_back(light(std::move(name), "|mean - 1| in standard errors", 5, kErrors, [=] {
            const auto print = convex ? litBall() : grooves();
            const Picture picture{bare(brdf, "constant:1,1,1"), 64, bounces, "path"};
            return offByErrors(render(*print, picture), 1, exact);
        }));
    };
    furnace("white furnace, matt ball", "lambert:1,1,1", 1, true, 1e-6);
    furnace("white furnace, matt grooves, 64 bounces", "lambert:1,1,1", 64, false, 1e-6);
    // The coat's table holds energy to 1e-4 an event.
    for (const double alpha : {1.0, 0.3, 0.05, 0.005, 0.001})
        furnace(fmt::format("white furnace, plastic of alpha {:g}", alpha), fmt::format("plastic:1,1,1,{}", alpha), 1,
                true, 3e-4);
    for (const char* brdf : {"lambert:1,1,1", "plastic:1,1,1,0.005"})
        cases.push_back(light(fmt::format("black furnace, {}", brdf), "brightest pixel", 0, "no light makes none", [=] {
            return brightest(render(*grooves(), {bare(brdf, "constant:0,0,0"), 16, 16, "path"}));
        }));
    cases.push_back(light("black body in a bright room", "brightest pixel", 0, "an albedo of 0 returns nothing", [] {
        return brightest(render(*litBall(), {bare("lambert:0,0,0", "constant:1e6,1e6,1e6"), 16, 8, "path"}));
    }));
}

void addLamps(std::vector<StabilityCase>& cases) {
    for (const double irradiance : {1e-6, 1.0, 1e6})
        cases.push_back(
            light(fmt::format("matt ball lit with {:g}", irradiance), "relative error of its middle", 3e-4,
                  "a pixel sees normals within 0.014 and the trilinear one is off by voxel / 2R = 0.01: 1 - cos(0.024)",
                  [=] { return middleOfALitBall(irradiance); }));
}

}  // namespace

std::vector<StabilityCase> lightCases() {
    std::vector<StabilityCase> cases;
    addFurnaces(cases);
    addLamps(cases);
    return cases;
}

}  // namespace stratum::study
