// The command line of vdbtrace for films: what moves, for how long, and into which file.
#pragma once

#include "animate/camera_path.h"

#include <CLI/CLI.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace stratum::tools {

struct FilmCommand {
    std::string output;    ///< --film; empty: pictures
    double seconds = 0.0;  ///< --seconds
    bool seconds_given = false;
    int rate = 0;             ///< --fps; 0: not given
    std::string grow;         ///< --grow: time, filament, or empty
    std::string camera_path;  ///< --camera-path: a file, or empty
    bool turn = false;        ///< --turntable
    double turns = 1.0;       ///< revolutions, if it turns

    // Found by planFilm():
    std::size_t frames = 0;
    std::vector<animate::CameraKey> keys;  ///< of --camera-path
};

void addFilmOptions(CLI::App& app, FilmCommand& film, bool& nozzle);

/// What of them is on this command line besides --film itself, "--fps, --grow".
std::string givenFilmOptions(const FilmCommand& film);

}  // namespace stratum::tools
