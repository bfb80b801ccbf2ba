// The parts of the study of deposition: each has a table of its own and a piece of the page.
#pragma once

#include "deposit/read_print.h"
#include "study/deposit/deposit.h"
#include "study/report/page.h"
#include "study/report/result_table.h"

#include <memory>
#include <string>

namespace stratum::study {

/// Each goes on with the rows of its table, measures the others, and adds to the page and the findings. The table is
/// returned, to be counted. Throws InputError, UsageError, OutputError.
using PartTable = std::unique_ptr<ResultTable>;
PartTable studyVolume(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);
PartTable studyRoughness(const StudyOptions& common, Page& page, StudyReport& report);
PartTable studyCorner(const StudyOptions& common, Page& page, StudyReport& report);
PartTable studyTimes(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);
PartTable studyEffects(const DepositOptions& options, const StudyOptions& common, Page& page, StudyReport& report);

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
