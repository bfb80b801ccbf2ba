// What all studies share: where results go, how much to do, and how far they are.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace stratum::study {

struct StudyOptions {
    std::filesystem::path folder;      ///< for NAME.csv and NAME.html; must exist
    bool quick = false;                ///< fewer and smaller configurations
    bool fresh = false;                ///< forget the rows of an earlier run
    int threads = 0;                   ///< for the processes of a study's own; 0: as many as the machine has
    std::vector<std::string> command;  ///< as typed, for the page
    /// Called after each configuration with the fraction done, 0..1. May be empty.
    std::function<void(double)> progress;
};

/// What a study leaves behind.
struct StudyReport {
    std::filesystem::path csv, html;
    std::size_t rows = 0;
    std::size_t resumed = 0;            ///< of them, from an earlier run
    std::vector<std::string> findings;  ///< what the reader should know: failed cases, costs that should not be
};

}  // namespace stratum::study
