// The studies: what each is asked, and what it leaves behind. All throw InputError, UsageError, OutputError.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace stratum::study {

struct StudyOptions {
    std::filesystem::path folder{};      ///< for NAME.csv and NAME.html; must exist
    bool quick = false;                  ///< fewer and smaller configurations
    int threads = 0;                     ///< 0: as many as the machine has
    std::vector<std::string> command{};  ///< as typed, for the page
    /// Called after each configuration with the fraction done, 0..1. May be empty.
    std::function<void(double)> progress{};

    void tell(std::size_t done, std::size_t all) const {
        if (progress) progress(static_cast<double>(done) / static_cast<double>(all));
    }
};

/// What a study leaves behind.
struct StudyReport {
    std::filesystem::path csv, html;
    std::size_t rows = 0;
    std::vector<std::string> findings;  ///< what the reader should know: failed cases, costs that should not be
};

struct MemoryOptions {
    std::vector<std::string> prints;    ///< G-code files
    std::vector<int> voxels_per_layer;  ///< empty: 1 to 4, or 1 to 3 if quick
    double memory_share = 0.5;          ///< of what the machine has available: larger grids are left out
};

/// Builds every print at every voxel size, kept and culled, and kept without a grid, each in a process of its own.
/// memory.csv: bytes of the grid, on disk as floats and halves, as bricks, peak resident set of converting; leaves,
/// tiles, active voxels; seconds. memory.html: power laws, and how far off each is at the finest size when fitted
/// without it.
StudyReport studyMemory(const MemoryOptions& options, const StudyOptions& common);

struct GeometryOptions {
    std::string print;           ///< a G-code file
    std::string layers;          ///< "A:B", see voxelize::parseLayers; empty: all
    std::vector<double> counts;  ///< voxels a layer, need not be whole; empty: 1, 2, 3, 4, 6, 8, or 1, 2, 4 if quick
    std::size_t points = 0;      ///< on the union's surface; 0: 40000, or 4000 if quick
};

/// geometry.csv and geometry.html: errors against voxel size, on lattices aligned with the layers and half a voxel off,
/// for several half-widths, as floats and halves, of the beads' union and of settled beads, each against its own exact
/// surface; and against run time. Both ways: from the exact surface to the level set, with the share of it that is not
/// there, and back. Level beads only.
StudyReport studyGeometry(const GeometryOptions& options, const StudyOptions& common);

struct RenderStudyOptions {
    std::string print;  ///< a G-code file
    std::vector<int>
        per_layer;  ///< voxel sizes, voxels a layer; the finest is what the others are held against. Empty:
                    ///< 1, 2, 4, 8, or 1, 2 if quick. The middle one, by size, serves all other comparisons
    int seeds = 0;  ///< pictures of each kind that differ by their noise alone; 0: 5, or 2 if quick
};

/// render.csv and render.html: relative squared error and mean FLIP against references, over wall and CPU time, for
/// intersectors, integrators, ways to sample, voxel sizes, and with and without the denoiser. References have 64 times
/// as many samples as the best picture and numbers of their own.
StudyReport studyRender(const RenderStudyOptions& options, const StudyOptions& common);

/// Runs all cases, each in a process of its own, so that one that crashes or hangs fails alone. stability.csv and
/// stability.html; what failed is among the findings. Cases don't depend on --quick: they are quick.
StudyReport studyStability(const StudyOptions& common);

struct NeedOptions {
    std::vector<std::string> prints;  ///< G-code files
    int repeats = 0;                  ///< runs of each; 0: 7, or 3 if quick
};

/// Converts and renders each print with every capability off, and with each one alone switched on; every run is a
/// process of its own, and the kinds take turns. need.csv has every run; need.html the medians: seconds and peak bytes
/// with and without. A second series with everything off tells how far two medians of the same thing are apart.
StudyReport studyNeed(const NeedOptions& options, const StudyOptions& common);

struct DepositOptions {
    std::vector<std::string> prints;  ///< G-code files, for their volume; may be empty: then only what is made here
    std::vector<std::string> timed;   ///< more of them, in any container, for their times alone
    std::string layers;               ///< of the volumes: "A:B", see voxelize::parseLayers; empty: "1:20"
};

/// deposit_volume.csv, deposit_roughness.csv, deposit_corner.csv, deposit_time.csv and deposit.html:
/// volume of union, settled beads and a typical printer against what was fed; Ra and Rz of stacked walls beside
/// published figures; width of a corner against the lag; stated against planned times.
StudyReport studyDeposit(const DepositOptions& options, const StudyOptions& common);

struct PeerTracers;  // polygons/peer_tracers.h

struct PolygonsOptions {
    std::vector<std::string> scenes;       ///< scene files of spheres, boxes and cylinders
    std::vector<std::string> prints;       ///< G-code files, or folders of them
    std::string environment;               ///< of the prints' pictures, see shade::makeEnvironment; empty: studio
    std::vector<std::string> integrators;  ///< of the prints' pictures: path, ao; empty: both
    int spp = 0;     ///< of the prints' path-traced pictures; 0: 32, or 4 if quick. Totals are told for 32
    int frames = 0;  ///< of each scene; 0: 10, or 2 if quick
};

/// polygons_scenes.csv, polygons_prints.csv and polygons.html. Peers that this program has not are named in the
/// findings.
StudyReport studyPolygons(const PolygonsOptions& options, const PeerTracers& peers, const StudyOptions& common);

}  // namespace stratum::study
