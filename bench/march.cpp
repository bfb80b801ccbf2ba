// bench/march: rays a second of every intersector and of its peers, on the same rays, in one process.
//
// Each peer traces each set of rays once per round, in turn with the others, so that what disturbs the machine disturbs
// all. Reported are medians over rounds, their spread, ratios, and how answers differ from the scalar exact ones.
#include "embree_intersector.h"
#include "embree_scene.h"
#include "march_rays.h"

#include "base/input_file.h"
#include "base/parallel_for.h"
#include "gcode/reader.h"
#include "march/brick/brick_intersector.h"
#include "march/file/level_set_file.h"
#include "march/reference/reference_intersectors.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/global_control.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <functional>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace stratum;
using Json = nlohmann::ordered_json;
using IntersectorPtr = std::shared_ptr<const trace::Intersector>;

struct Options {
    std::string grid, gcode, json;
    std::vector<std::string> peers, sets;
    int side = 1024, rounds = 7, threads = 2;
};

double secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Of all threads together: what other processes take from the machine is not counted.
double cpuSecondsOf(const std::function<void()>& work) {
    const auto now = [] {
        timespec t{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    };
    const double start = now();
    work();
    return now() - start;
}

// What is compared: an intersector, asked by streams of rays or ray by ray.
struct Peer {
    std::string name;
    IntersectorPtr intersector;
    bool streams = true;
    double build_seconds = 0;
    bool either = false;  // of both ways the one that is faster in the round that warms up
};

Peer embreePeer(std::string name, const std::function<std::unique_ptr<bench::EmbreeScene>()>& make) {
    Peer peer{"embree " + std::move(name), nullptr, true, 0, true};
    peer.build_seconds = secondsOf([&] { peer.intersector = bench::embreeIntersector(make(), {}); });
    return peer;
}

std::unique_ptr<bench::EmbreeScene> meshScene(const openvdb::FloatGrid& grid) {
    std::vector<openvdb::Vec3s> points;
    std::vector<openvdb::Vec4I> faces;
    openvdb::tools::volumeToMesh(grid, points, faces, 0.0);
    std::vector<bench::Corner> corners;
    for (const openvdb::Vec3s& p : points) corners.push_back({p[0], p[1], p[2]});
    std::vector<bench::Quad> quads;
    for (const openvdb::Vec4I& f : faces) quads.push_back({{f[0], f[1], f[2], f[3]}});
    return bench::quadScene(corners, quads);
}

struct Answers {
    std::vector<double> t;
    std::vector<std::uint8_t> blocked;
};

// By all threads, in tiles of 1024 rays.
void traceRays(const Peer& peer, std::span<const trace::Ray> rays, bool any, Answers& answers) {
    constexpr std::size_t kChunk = 1024;
    answers.t.resize(any ? 0 : rays.size());
    answers.blocked.resize(any ? rays.size() : 0);
    PerThread<std::unique_ptr<trace::Tracer>> tracers([&peer] { return peer.intersector->makeTracer(); });
    parallelFor((rays.size() + kChunk - 1) / kChunk, 1, [&](std::size_t first_chunk, std::size_t last_chunk) {
        const std::size_t first = first_chunk * kChunk;
        const std::size_t count = std::min(last_chunk * kChunk, rays.size()) - first;
        trace::Tracer& tracer = *tracers.local();
        if (any && peer.streams) {
            tracer.occludedStream(rays.subspan(first, count), {answers.blocked.data() + first, count});
            return;
        }
        std::vector<trace::Hit> hits(any ? 0 : count);
        if (!any && peer.streams) tracer.intersectStream(rays.subspan(first, count), hits);
        for (std::size_t n = 0; n < count; ++n) {
            if (any)
                answers.blocked[first + n] = tracer.occluded(rays[first + n]) ? 1 : 0;
            else if (!peer.streams && !tracer.intersect(rays[first + n], hits[n]))
                hits[n].t = std::numeric_limits<double>::infinity();
            if (!any) answers.t[first + n] = hits[n].t;
        }
    });
}

// How a peer's answers differ from the exact ones.
struct Difference {
    std::size_t missed = 0, extra = 0, off = 0;  // off: by more than a hundredth of a voxel
    double mean_error = 0;                       // of t where both hit, voxels
};

Difference compare(const Answers& exact, const Answers& other, bool any, double voxel) {
    Difference d;
    std::size_t both = 0;
    const std::size_t count = any ? exact.blocked.size() : exact.t.size();
    for (std::size_t n = 0; n < count; ++n) {
        const bool a = any ? exact.blocked[n] != 0 : std::isfinite(exact.t[n]);
        const bool b = any ? other.blocked[n] != 0 : std::isfinite(other.t[n]);
        d.missed += a && !b ? 1 : 0;
        d.extra += !a && b ? 1 : 0;
        if (any || !a || !b) continue;
        const double error = std::abs(exact.t[n] - other.t[n]) / voxel;
        d.mean_error += error;
        d.off += error > 0.01 ? 1 : 0;
        ++both;
    }
    if (both > 0) d.mean_error /= static_cast<double>(both);
    return d;
}

void run(const Options& o) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(o.threads));
    openvdb::initialize();
    openvdb::FloatGrid::Ptr grid;
    double read_cpu = 0;
    const double read_seconds =
        secondsOf([&] { read_cpu = cpuSecondsOf([&] { grid = march::readLevelSet(o.grid, ""); }); });
    const double voxel = grid->voxelSize()[0];
    fmt::print("{}: {:.1f} M active voxels of {:g}, {:.2f} GB, read in {:.2f} s; {} threads, {} rounds\n", o.grid,
               1e-6 * static_cast<double>(grid->activeVoxelCount()), voxel,
               1e-9 * static_cast<double>(grid->memUsage()), read_seconds, o.threads, o.rounds);

    std::vector<Peer> peers;
    const auto wanted = [&](const std::string& name) {
        return o.peers.empty() || std::find(o.peers.begin(), o.peers.end(), name) != o.peers.end();
    };
    IntersectorPtr brick;  // exact: what the others' answers are compared with
    IntersectorPtr quanta;
    double brick_cpu = 0;
    double quanta_cpu = 0;
    const auto build = [&grid](auto& made, march::BrickValues values, double& cpu) {
        return secondsOf([&] { cpu = cpuSecondsOf([&] { made = march::makeBrickIntersector(*grid, values); }); });
    };
    const double brick_seconds = build(brick, march::BrickValues::Float32, brick_cpu);
    const double quanta_seconds = build(quanta, march::BrickValues::Int16, quanta_cpu);
    for (const bool streams : {false, true})
        if (const std::string name = streams ? "brick" : "brick scalar"; wanted(name)) {
            peers.push_back({name + ", floats", brick, streams, brick_seconds});
            peers.push_back({name, quanta, streams, quanta_seconds});
        }
    if (wanted("vdb")) peers.push_back({"vdb", march::makeVdbIntersector(grid), false});
    if (wanted("sphere")) {
        peers.push_back({"sphere", march::makeSphereIntersector(grid, 1), false});
        peers.push_back({"sphere, relaxed", march::makeSphereIntersector(grid), false});
    }
    if (wanted("mesh")) peers.push_back(embreePeer("mesh", [&] { return meshScene(*grid); }));
    if (!o.gcode.empty()) {
        const InputFile file(o.gcode);
        const gcode::Toolpath toolpath = gcode::readToolpath(file.bytes(), o.gcode);
        for (const double split : {0.0, 16.0, 8.0})
            if (wanted("beads"))
                peers.push_back(embreePeer(split > 0 ? fmt::format("beads, {:g}:1", split) : "beads, whole",
                                           [&] { return bench::beadScene(toolpath, split); }));
        if (wanted("curves")) {
            peers.push_back(embreePeer("round curves", [&] { return bench::roundScene(toolpath); }));
            peers.push_back(embreePeer("flat curves", [&] { return bench::ribbonScene(toolpath); }));
        }
        for (const int corners : {4, 6, 10})
            if (wanted("prisms"))
                peers.push_back(embreePeer(fmt::format("{}-gons, 8:1", corners),
                                           [&] { return bench::prismScene(toolpath, corners, 8); }));
    }

    fmt::print("  reading took {:.2f} s of CPU time, building bricks {:.2f} s, of floats {:.2f} s\n", read_cpu,
               quanta_cpu, brick_cpu);
    for (const Peer& peer : peers)
        fmt::print("  {:<28} built in {:6.2f} s, {:8.1f} MB\n", peer.name, peer.build_seconds,
                   1e-6 * static_cast<double>(peer.intersector->bytes()));

    const auto sets = bench::makeRaySets(*brick, o.side, 0.1 * voxel);
    Json report{{"grid", o.grid},
                {"active_voxels", grid->activeVoxelCount()},
                {"read_seconds", read_seconds},
                {"read_cpu_seconds", read_cpu},
                {"brick_cpu_seconds", quanta_cpu},
                {"brick_floats_cpu_seconds", brick_cpu}};
    for (const bench::RaySet& set : sets) {
        if (!o.sets.empty() && std::find(o.sets.begin(), o.sets.end(), set.name) == o.sets.end()) continue;
        std::vector<Answers> answers(peers.size());
        std::vector<std::vector<double>> seconds(peers.size());
        for (int round = -1; round < o.rounds; ++round)  // the first warms up
            for (std::size_t p = 0; p < peers.size(); ++p) {
                const auto secondsBy = [&](bool streams) {
                    peers[p].streams = streams;
                    return cpuSecondsOf([&] { traceRays(peers[p], set.rays, set.any, answers[p]); });
                };
                if (round < 0 && peers[p].either) peers[p].streams = secondsBy(true) < secondsBy(false);
                const double s = secondsBy(peers[p].streams);
                if (round >= 0) seconds[p].push_back(s / o.threads);
            }
        fmt::print("\n{}: {:.2f} M rays\n", set.name, 1e-6 * static_cast<double>(set.rays.size()));
        double first_rate = 0;
        for (std::size_t p = 0; p < peers.size(); ++p) {
            std::sort(seconds[p].begin(), seconds[p].end());
            const double count = static_cast<double>(set.rays.size()) * 1e-6;
            const double rate = count / seconds[p][seconds[p].size() / 2];
            if (p == 0) first_rate = rate;
            const Difference d = compare(answers[0], answers[p], set.any, voxel);
            fmt::print(
                "  {:<28} {:7.2f} Mrays/s ({:5.2f} to {:5.2f})  {:5.2f} x scalar   missed {:7} extra {:7} "
                "off {:7}, mean {:.1e} voxel\n",
                peers[p].name, rate, count / seconds[p].back(), count / seconds[p].front(), rate / first_rate, d.missed,
                d.extra, d.off, d.mean_error);
            report["sets"][set.name][peers[p].name] = {{"mrays_per_second", rate},
                                                       {"least", count / seconds[p].back()},
                                                       {"most", count / seconds[p].front()},
                                                       {"missed", d.missed},
                                                       {"extra", d.extra},
                                                       {"off", d.off},
                                                       {"mean_error_voxels", d.mean_error}};
        }
        report["sets"][set.name]["rays"] = set.rays.size();
    }
    for (const Peer& peer : peers)
        report["peers"][peer.name] = {{"build_seconds", peer.build_seconds}, {"bytes", peer.intersector->bytes()}};
    if (!o.json.empty()) std::ofstream(o.json) << report.dump(2) << '\n';
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Rays a second of intersectors and their peers.", "bench_march");
    Options o;
    app.add_option("GRID", o.grid, "A level set")->required();
    app.add_option("--gcode", o.gcode, "What it was made from: adds peers that trace beads");
    app.add_option("--peers", o.peers,
                   "Only these of: brick scalar, brick, vdb, sphere, mesh, beads, curves, prisms (default: all)")
        ->delimiter(',');
    app.add_option("--sets", o.sets, "Only these rays, by the names that are printed (default: all)");
    app.add_option("--side", o.side, "Pixels of the picture, a multiple of 32 (default 1024)");
    app.add_option("--rounds", o.rounds, "Timed rounds (default 7)");
    app.add_option("--threads", o.threads, "Threads (default 2)");
    app.add_option("--json", o.json, "Write all figures here");
    CLI11_PARSE(app, argc, argv);
    try {
        run(o);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_march: {}\n", error.what());
        return 1;
    }
    return 0;
}
