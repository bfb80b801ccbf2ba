// Values of a report as short text for people, in the units that they are read in.
#pragma once

#include "report/print_report.h"

#include <string>
#include <vector>

namespace stratum::report {

/// Four significant digits; large numbers whole.
std::string shortNumber(double value);

/// A number's value and unit: "3 h 12 min", "12.3 cm³", "(1.0, 2.0, 3.0) mm", three lines of a tensor.
std::string describeValue(const Number& number);
/// What else is known of it: "layer 12", "at (1, 2, 3) mm, line 400"; empty if nothing is.
std::string describeDetails(const Number& number);

/// Least, mean and largest of a column, and where.
struct ColumnRange {
    double least = 0, mean = 0, largest = 0;
    std::size_t least_at = 0, largest_at = 0;  ///< indices into the column
    bool any = false;
};
ColumnRange rangeOf(const Column& column);

/// Headings in the order of the definitions, with their numbers and those left out.
struct Section {
    std::string_view title;
    std::vector<const Number*> numbers;
    std::vector<const LeftOut*> left_out;
};
std::vector<Section> sectionsOf(const PrintReport& report);

/// One line: slicer, beads, voxels, selection.
std::string describePrint(const PrintReport& report);

}  // namespace stratum::report
