// Materials in the plane of incidence, as CSV: what bench/lobes.py draws for docs/shading.md.
#include "shade/brdf/brdf.h"
#include "shade/finish/named_brdf.h"
#include "shade/measured/brdf_file.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <variant>
#include <vector>

namespace {

using namespace stratum;

constexpr double kRadians = std::numbers::pi / 180.0;

/// Towards something in the plane of incidence: the light stands at negative angles.
glm::vec3 inPlane(double degrees) { return {std::sin(degrees * kRadians), 0.0, std::cos(degrees * kRadians)}; }

void print(const std::string& material, const char* what, double light, double detector, const shade::Color& f) {
    fmt::print("{},{},{:g},{:g},{:.6g},{:.6g},{:.6g}\n", material, what, light, detector, f.r, f.g, f.b);
}

/// What the instrument read, both sides of the plane averaged.
void printReadings(const std::string& material, const shade::BrdfScan& scan) {
    for (std::size_t i = 0; i < scan.incidences.size(); ++i) {
        const double light = scan.incidences[i] / kRadians;
        for (int detector = -85; detector <= 85; detector += 5)
            print(material, "reading", light, detector,
                  shade::Color(
                      shade::scanAt(scan, i, detector < 0 ? 0.0 : std::numbers::pi, std::abs(detector) * kRadians)));
    }
}

void printTable(const std::string& material, const shade::Brdf& brdf) {
    for (const double light : {0.0, 20.0, 30.0, 40.0, 50.0, 60.0, 75.0})
        for (double detector = -89.0; detector <= 89.0; detector += 0.5)
            print(material, "table", light, detector, brdf.eval(inPlane(detector), inPlane(-light)));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("The values of materials in the plane of incidence, and the readings they were made of");
    std::vector<std::string> materials;
    app.add_option("MATERIAL", materials, "As vdbtrace --brdf takes them")->required();
    CLI11_PARSE(app, argc, argv);
    try {
        fmt::print("material,what,light_degrees,detector_degrees,r,g,b\n");
        for (const std::string& material : materials) {
            const bool is_file = std::filesystem::exists(material);
            const std::string name = is_file ? std::filesystem::path(material).stem().stem().string() : material;
            if (is_file) {
                const shade::MeasuredMaterial measured = shade::readMeasuredMaterial(material);
                if (const auto* scan = std::get_if<shade::BrdfScan>(&measured.data))
                    printReadings(name, shade::foldScan(*scan));
            }
            printTable(name, *shade::makeBrdf(material));
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_lobes: {}\n", error.what());
        return 1;
    }
}
