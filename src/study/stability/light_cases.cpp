// Light in furnaces, under suns, on mirrors and at grazing angles.
//
// A mean of random samples is judged by its own standard error s, taken from the spread of blocks of pixels: a right
// mean is off by more than 5 s once in a million.
#include "march/brick/brick_intersector.h"
#include "shade/brdf/brdf.h"
#include "shade/brdf/lambert.h"
#include "shade/brdf/plastic.h"
#include "shade/environment/constant.h"
#include "shade/integrator/render.h"
#include "shade/light/directional.h"
#include "shade/scene/scene.h"
#include "study/geometry/field_error.h"
#include "study/geometry/handmade.h"
#include "study/stability/stability_case.h"

#include <fmt/format.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace stratum::study {
namespace {

using shade::Color;

constexpr int kSide = 96;  // pixels of the frame

std::unique_ptr<trace::Intersector> ballShape() {
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

// Pixels that are not finite or are negative.
double badPixels(const shade::Film& film) {
    int bad = 0;
    for (const shade::Pixel& pixel : film.pixels())
        for (int c = 0; c < 3; ++c) bad += std::isfinite(pixel.rgb[c]) && pixel.rgb[c] >= 0 ? 0 : 1;
    return bad;
}

double brightest(const shade::Film& film) {
    double most = 0;
    for (const shade::Pixel& pixel : film.pixels())
        for (int c = 0; c < 3; ++c) most = std::max(most, static_cast<double>(pixel.rgb[c]));
    return most;
}

glm::vec3 at(double cosine, double turn) {
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return {static_cast<float>(sine * std::cos(turn)), static_cast<float>(sine * std::sin(turn)),
            static_cast<float>(cosine)};
}

// A radical inverse: a stratified sequence that needs no state.
double radicalInverse(unsigned n, unsigned base) {
    double value = 0;
    double digit = 1.0 / base;
    for (; n > 0; n /= base, digit /= base) value += digit * (n % base);
    return value;
}

// By how many standard errors the albedo at this angle is above 1, from the BRDF's own samples. What the coat's table
// holds (1e-4) and floats do not count.
double albedoAboveOne(const shade::Brdf& brdf, double cosine) {
    constexpr int kSamples = 1 << 17;
    std::mt19937 random(12);
    std::uniform_real_distribution<float> unit(0, 0x1.fffffep-1F);
    double sum = 0;
    double squares = 0;
    const glm::vec3 wo = at(cosine, 0.3);
    for (int n = 0; n < kSamples; ++n) {
        const auto sample = brdf.sample(wo, unit(random), {unit(random), unit(random)});
        if (!sample) continue;
        const auto weight =
            static_cast<double>(std::max({sample->f.r, sample->f.g, sample->f.b}) * sample->wi.z / sample->pdf);
        sum += weight;
        squares += weight * weight;
    }
    const double mean = sum / kSamples;
    const double above = std::max(mean - 1 - 2e-4, 0.0);
    // Not max(): a NaN must stay one.
    if (!std::isfinite(mean)) return mean;
    return above == 0 ? 0 : above / std::sqrt((squares / kSamples - mean * mean) / kSamples);
}

// Of pairs of directions, also at grazing angles, the largest |f(a, b) - f(b, a)| over their sum.
double asymmetry(const shade::Brdf& brdf) {
    double largest = 0;
    for (unsigned n = 1; n < 20000; ++n) {
        const double squeeze = n % 4 == 0 ? 1e-4 : 1;
        const glm::vec3 a = at(squeeze * radicalInverse(n, 2), 2 * std::numbers::pi * radicalInverse(n, 3));
        const glm::vec3 b = at(radicalInverse(n, 5), 2 * std::numbers::pi * radicalInverse(n, 7));
        if (!(a.z > 0) || !(b.z > 0)) continue;
        const Color one = brdf.eval(a, b);
        const Color other = brdf.eval(b, a);
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(one[c]) || one[c] < 0) return std::numeric_limits<double>::infinity();
            const double sum = static_cast<double>(one[c]) + static_cast<double>(other[c]);
            if (sum > 1e-30)
                largest =
                    std::max(largest, std::abs(static_cast<double>(one[c]) - static_cast<double>(other[c])) / sum);
        }
    }
    return largest;
}

// Of the samples' own values against eval() and pdf(), the largest relative difference.
double sampleDisagrees(const shade::Brdf& brdf) {
    double largest = 0;
    for (unsigned n = 1; n < 20000; ++n) {
        const glm::vec3 wo = at(n % 3 == 0 ? 1e-4 : radicalInverse(n, 7), 0.2);
        const auto sample =
            brdf.sample(wo, static_cast<float>(radicalInverse(n, 5)),
                        {static_cast<float>(radicalInverse(n, 2)), static_cast<float>(radicalInverse(n, 3))});
        if (!sample) continue;
        const auto pdf = static_cast<double>(brdf.pdf(wo, sample->wi));
        largest = std::max(largest, std::abs(static_cast<double>(sample->pdf) / pdf - 1));
        const auto f = static_cast<double>(brdf.eval(wo, sample->wi).r);
        if (f > 0) largest = std::max(largest, std::abs(static_cast<double>(sample->f.r) / f - 1));
        if (!std::isfinite(largest)) return std::numeric_limits<double>::infinity();
    }
    return largest;
}

// A matt ballShape of albedo 1 lit from behind the camera with irradiance pi: its middle shines with radiance 1.
double middleOfALitBall(double irradiance) {
    const auto print = ballShape();
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

// Of a sun this wide: radiance times solid angle against the paper's. A disc of half angle h that gives the irradiance
// E to a surface that faces it has the radiance E / (pi sin^2 h) and 2 pi (1 - cos h) steradians: 2 E / (1 + cos h).
double sunLosesLight(float degrees) {
    const shade::SunLight sun(glm::normalize(glm::vec3(1, 2, 3)), Color(7.0F), degrees);
    const double expected = 2 * 7 / (1 + std::cos(static_cast<double>(degrees) / 2 * std::numbers::pi / 180));
    double largest = 0;
    for (unsigned n = 0; n < 1000; ++n) {
        const auto sample = sun.sample(
            glm::dvec3(1, 2, 3), {static_cast<float>(radicalInverse(n, 2)), static_cast<float>(radicalInverse(n, 3))});
        if (!sample) return std::numeric_limits<double>::infinity();
        largest = std::max(largest, std::abs(static_cast<double>(sample->light.r / sample->pdf) / expected - 1));
    }
    return largest;
}

void addFurnaces(std::vector<StabilityCase>& cases) {
    const auto furnace = [&cases](std::string name, const std::string& brdf, int bounces, bool convex, double exact) {
        cases.push_back(light(std::move(name), "|mean - 1| in standard errors", 5, kErrors, [=] {
            const auto print = convex ? ballShape() : grooves();
            const Picture picture{bare(brdf, "constant:1,1,1"), 64, bounces, "path"};
            return offByErrors(render(*print, picture), 1, exact);
        }));
    };
    furnace("white furnace, matt ballShape", "lambert:1,1,1", 1, true, 1e-6);
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
        return brightest(render(*ballShape(), {bare("lambert:0,0,0", "constant:1e6,1e6,1e6"), 16, 8, "path"}));
    }));
}

void addSuns(std::vector<StabilityCase>& cases) {
    for (const double alpha : {0.001, 0.005})
        for (const int spp : {1, 64})
            cases.push_back(light(
                fmt::format("alpha {:g} under a sun of 1e5 : 1, {} spp", alpha, spp),
                "channels that are not finite or negative", 0, "light is a number, and not below 0", [=] {
                    Picture picture{bare(fmt::format("plastic:0.5,0.1,0,{}", alpha), "constant:1,1,1"), spp, 8, "path"};
                    // The sun's radiance is its irradiance over 6.7e-5 sr: 1e5 times the room's.
                    picture.scene.lights = {"sun:1,2,-1,6.7,6.7,6.7"};
                    return badPixels(render(*grooves(), picture));
                }));
    for (const double irradiance : {1e-6, 1.0, 1e6})
        cases.push_back(
            light(fmt::format("matt ballShape lit with {:g}", irradiance), "relative error of its middle", 3e-4,
                  "a pixel sees normals within 0.014 and the trilinear one is off by voxel / 2R = 0.01: 1 - cos(0.024)",
                  [=] { return middleOfALitBall(irradiance); }));
    for (const float degrees : {0.001F, 0.53F, 90.0F})
        cases.push_back(light(fmt::format("sun {:g} degrees wide", degrees), "relative error of its irradiance",
                              4 * 0x1p-23, "four float roundings: radiance, density, their making and their ratio",
                              [=] { return sunLosesLight(degrees); }));
    cases.push_back(light("one sample, one bounce", "channels that are not finite or negative", 0,
                          "light is a number, and not below 0", [] {
                              return badPixels(render(*grooves(), {bare("plastic:1,1,1,0.001", "sky"), 1, 1, "path"}));
                          }));
}

void addMaterials(std::vector<StabilityCase>& cases) {
    for (const double alpha : {0.001, 0.1, 1.0})
        for (const double cosine : {1.0, 1e-2, 1e-4})
            cases.push_back(
                light(fmt::format("albedo of plastic {:g} at a cosine of {:g}", alpha, cosine),
                      "standard errors above 1", 5, kErrors,
                      [=] { return albedoAboveOne(shade::Plastic(Color(1.0F), static_cast<float>(alpha)), cosine); }));
    for (const double alpha : {0.001, 0.05, 1.0}) {
        cases.push_back(
            light(fmt::format("plastic {:g} both ways", alpha), "largest asymmetry", 32 * 0x1p-24,
                  "both ways have the same half vector to the bit; what is left are some 32 roundings of 2^-24",
                  [=] { return asymmetry(shade::Plastic(Color(0.5F), static_cast<float>(alpha))); }));
        cases.push_back(light(fmt::format("samples of plastic {:g}", alpha), "largest relative difference",
                              16 * 0x1p-24 / alpha,
                              "sample() draws a half vector, eval() makes it anew: roundings of 2^-24 over the lobe's "
                              "width, to the fourth power of their sum",
                              [=] { return sampleDisagrees(shade::Plastic(Color(0.5F), static_cast<float>(alpha))); }));
    }
}

}  // namespace

std::vector<StabilityCase> lightCases() {
    std::vector<StabilityCase> cases;
    addFurnaces(cases);
    addSuns(cases);
    addMaterials(cases);
    return cases;
}

}  // namespace stratum::study
