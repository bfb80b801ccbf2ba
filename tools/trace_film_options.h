// The command line of vdbtrace for films: what moves, for how long, and into which file.
#pragma once

#include "animate/camera_path.h"
#include "assemble/hot_end.h"
#include "base/names.h"
#include "voxelize/beads/growth.h"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace stratum::tools {

struct FilmCommand {
    std::string output;    ///< --film; empty: pictures
    double seconds = 0.0;  ///< --seconds
    bool seconds_given = false;
    double rate = 0;             ///< --fps; 0: not given
    std::string grow;            ///< --grow: a name of kGrowths, or empty
    std::optional<double> hold;  ///< --hold
    double ease = 0.0;           ///< --ease, seconds
    std::string camera_path;     ///< --camera-path: a file, or empty
    bool turn = false;           ///< --turntable
    double turns = 1.0;          ///< revolutions, if it turns

    // Found by planFilm():
    std::size_t frames = 0, held = 0;      ///< all, and the last ones that show the finished print
    std::vector<animate::CameraKey> keys;  ///< of --camera-path
};

inline constexpr Names<voxelize::GrowthBy, 3> kGrowths = {{{"time", voxelize::GrowthBy::time},
                                                           {"filament", voxelize::GrowthBy::volume},
                                                           {"layers", voxelize::GrowthBy::layers}}};

/// @param nozzle  --nozzle, --clear-nozzle and --hot-end, which pictures have, too
void addFilmOptions(CLI::App& app, FilmCommand& film, assemble::HotEndLook& nozzle);

/// What of them is on this command line besides --film itself, "--fps, --grow".
std::string givenFilmOptions(const FilmCommand& film);

}  // namespace stratum::tools
