// The HTML page of a study: text, tables, plots and pictures in one file.
#pragma once

#include "report/text/html_page.h"
#include "study/report/table.h"
#include "study/study.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stratum::study {

using report::Plot;
using report::Series;

class Page {
public:
    /// `command`: what was typed. Names of folders in it are left out: the page is read on other machines.
    Page(std::string title, std::span<const std::string> command);

    void heading(std::string_view text);
    void paragraph(std::string_view text);
    /// Cells that are numbers are set flush right. A row whose cells hold `marked` is shown in red; empty marks none.
    void table(const Row& columns, const std::vector<Row>& rows, std::string_view marked = {});
    void table(const Table& table, std::string_view marked = {}) { this->table(table.columns(), table.rows(), marked); }
    void plot(const Plot& plot);
    /// A JPEG in base64, see jpegOf().
    void picture(std::string_view jpeg, std::string_view caption);

    std::string html() const;

private:
    std::string title_, made_by_, body_;
};

/// Processor, cores, memory, system, compiler; never the machine's name.
std::string machineLine();

/// Writes NAME.html; and NAME.csv, for studies of one table, and tells of both. Throws OutputError.
void writePage(const StudyOptions& common, const std::string& name, const Page& page, StudyReport& report);
void writeTable(const StudyOptions& common, const std::string& name, const Table& table, StudyReport& report);

}  // namespace stratum::study
