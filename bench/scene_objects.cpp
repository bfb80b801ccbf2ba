// What finding the objects of a scene costs a ray: one by one against the tree, the same part many times, one thread.
//
// Both in one process, run by run in turn; every answer of one is compared with the other's, to the bit.
#include "march_rays.h"

#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "study/cost/times.h"
#include "trace/scene_intersector.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <vector>

using namespace stratum;
using study::median;

namespace {

constexpr std::size_t kStream = 1024;

/// On a square plate, or in a cube; a fifth of the part's size apart.
std::vector<trace::SceneObject> manyOf(const std::shared_ptr<const trace::Intersector>& part, int count, bool cube) {
    const trace::Box box = part->bounds();
    const glm::dvec3 pitch = 1.2 * (box.max - box.min);
    const double power = cube ? 1.0 / 3.0 : 0.5;
    const int side = static_cast<int>(std::ceil(std::pow(count, power) - 1e-9));
    std::vector<trace::SceneObject> objects;
    for (int n = 0; n < count; ++n) {
        const glm::dvec3 place(n % side, n / side % side, n / (side * side));
        const glm::dvec3 flat(n % side, n / side, 0);
        objects.push_back({part, {glm::dmat3(1.0), pitch * (cube ? place : flat)}});
    }
    return objects;
}

struct Answers {
    std::vector<trace::Hit> hits;
    std::vector<std::uint8_t> blocked;
};

/// Returns seconds.
double seconds(trace::Tracer& tracer, const bench::RaySet& set, Answers& answers) {
    answers.hits.resize(set.any ? 0 : set.rays.size());
    answers.blocked.resize(set.any ? set.rays.size() : 0);
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t n = 0; n < set.rays.size(); n += kStream) {
        const std::size_t count = std::min(kStream, set.rays.size() - n);
        const auto rays = std::span(set.rays).subspan(n, count);
        if (set.any)
            tracer.occludedStream(rays, std::span(answers.blocked).subspan(n, count));
        else
            tracer.intersectStream(rays, std::span(answers.hits).subspan(n, count));
    }
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

bool same(const Answers& a, const Answers& b) {
    const auto equal = [](const trace::Hit& x, const trace::Hit& y) {
        return x.t == y.t && (!std::isfinite(x.t) || (x.object == y.object && x.normal == y.normal));
    };
    return a.blocked == b.blocked && std::equal(a.hits.begin(), a.hits.end(), b.hits.begin(), b.hits.end(), equal);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Times rays through scenes of many objects, with and without the tree over them");
    std::string input;
    int side = 256;
    int runs = 5;
    std::vector<int> counts{2, 4, 8, 16, 64, 256};
    app.add_option("input", input, "The part, a .vdb")->required();
    app.add_option("--side", side, "Pixels of the picture that sends the rays, a multiple of 32");
    app.add_option("--runs", runs, "Of each");
    app.add_option("--counts", counts, "Of objects");
    CLI11_PARSE(app, argc, argv);
    openvdb::initialize();
    const auto grid = march::readLevelSet(input, "");
    const auto part = std::shared_ptr<const trace::Intersector>(march::makeBrickIntersector(*grid));
    fmt::print("| objects | rays | Mrays/s, one by one | with the tree | ratio |\n|---|---|---|---|---|\n");
    for (const bool cube : {false, true})
        for (const int count : counts) {
            const auto objects = manyOf(part, count, cube);
            const auto plain = trace::makeSceneIntersector(objects, objects.size() + 1);
            const auto treed = trace::makeSceneIntersector(objects, 0);
            const auto loop = plain->makeTracer();
            const auto tree = treed->makeTracer();
            auto sets = bench::makeRaySets(*treed, side, plain->surfaceOffset());
            std::erase_if(sets,
                          [](const bench::RaySet& set) { return set.name != "primary" && set.name != "AO, 1 a hit"; });
            for (const bench::RaySet& set : sets) {
                Answers a;
                Answers b;
                std::vector<double> one;
                std::vector<double> other;
                std::vector<double> ratios;
                for (int run = 0; run < runs; ++run) {
                    one.push_back(seconds(*loop, set, a));
                    other.push_back(seconds(*tree, set, b));
                    ratios.push_back(one.back() / other.back());
                }
                if (!same(a, b)) {
                    fmt::print("{} objects, {}: the answers differ\n", count, set.name);
                    return 1;
                }
                const double rays = static_cast<double>(set.rays.size()) * 1e-6;
                fmt::print("| {}, {} | {} | {:.3g} | {:.3g} | {:.2f} |\n", count, cube ? "cube" : "plate", set.name,
                           rays / median(one), rays / median(other), median(ratios));
            }
        }
    return 0;
}
