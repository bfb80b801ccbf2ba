// One HTML file that holds all it shows: text, tables, plots, pictures.
#pragma once

#include "report/text/svg_plot.h"
#include "study/report/result_table.h"
#include "study/report/run_log.h"

#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace stratum::study {

using report::Plot;
using report::Series;

class Page {
public:
    /// `command`: what was typed. Names of folders in it are left out: the page is read on other machines.
    Page(std::string title, std::span<const std::string> command);

    void heading(std::string_view text);
    void paragraph(std::string_view text);
    /// Cells that are numbers are set flush right. A row whose cells hold `marked` is shown in red; empty marks none. A
    /// last column "run" refers to runs(). `lines`, if not empty: the lines of the CSV file that the rows were made of;
    /// a row can then be linked to as "#L12", or "#TABLE-L12" with the stem of the file as `table`.
    void table(const Row& columns, const std::vector<Row>& rows, std::string_view marked = {},
               std::span<const std::size_t> lines = {}, std::string_view table = {});
    /// Date, version, machine and command of all runs that rows shown so far refer to. `table`: the one that was opened
    /// last.
    void runs(const ResultTable& table);
    void plot(const Plot& plot);
    /// A file of PNG or JPEG, kept in the page.
    void picture(const std::filesystem::path& file, std::string_view caption);

    std::string html() const;
    /// Throws OutputError.
    void write(const std::filesystem::path& path) const;

private:
    std::string title_, made_by_, body_;
    std::set<std::string> runs_;  // that rows refer to
};

}  // namespace stratum::study
