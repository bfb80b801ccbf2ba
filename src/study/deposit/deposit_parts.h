// The parts of the study of deposition: each has a table of its own and a piece of the page.
#pragma once

#include "deposit/read_print.h"
#include "study/report/page.h"
#include "study/report/table.h"
#include "study/study.h"

#include <string>

namespace stratum::study {

/// Each measures its table, and adds to the page and the findings. Throws InputError, UsageError, OutputError.
Table studyVolume(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);
Table studyRoughness(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);
Table studyCorner(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);
Table studyTimes(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);

/// What beads become, by a name of the tables.
struct BeadModel {
    const char* name;
    const char* options;  ///< of gcode2vdb
    void (*set)(gcode::ReadOptions&);
};

/// Reads a G-code file of any container by a model.
deposit::PrintRead readByModel(const std::string& path, const BeadModel& model, bool timed = false);

/// Ra (mm) of a wall of layers of this height, whose outer side has corners of this radius: mean absolute deviation
/// from the mean over a period, by quadrature.
double wallRoughness(double height, double radius);

}  // namespace stratum::study
